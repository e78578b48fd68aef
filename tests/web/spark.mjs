// Spark's own reader (the worker of @sparkjsdev/spark, with its WebAssembly) on a .rad, without a browser.
// node spark.mjs MODULES decode FILE.rad OUT.ply: what it reads, as a .ply of floats, SH too; of a tree its leaves
// node spark.mjs MODULES cut FILE.rad SPLATS X,Y,Z OUT.ply: the nodes that it would draw, at most so many, from there
import { readFileSync, writeFileSync } from 'node:fs'

const [modules, command, file, ...rest] = process.argv.slice(2)
const source = readFileSync(`${modules}/@sparkjsdev/spark/dist/spark.module.js`, 'utf8')

// ---- The worker: a text in the module, which is given its WebAssembly by a message --------------------------------------

const wasm = Buffer.from(source.match(/\nconst WASM = decode64\("([^"]*)"\)/)[1], 'base64')
const text = Function(`return ${source.match(/\nconst jsContent = ('(?:[^'\\]|\\.)*')/)[1]}`)()
const listeners = new Set()
const waiting = new Map()
const self = {
    addEventListener: (_, listener) => listeners.add(listener),
    removeEventListener: (_, listener) => listeners.delete(listener),
    postMessage({ id, result, error }) {
        if (!waiting.has(id) || (result === undefined && error === undefined)) return
        const { resolve, reject } = waiting.get(id)
        error ? reject(error) : resolve(result)
    },
    location: { href: 'file:///' },
}
Function('self', text)(self)
const send = data => { for (const listener of [...listeners]) listener({ data }) }
send({ name: 'init-wasm', module: new WebAssembly.Module(wasm) })
let calls = 0
const call = (name, args) => new Promise((resolve, reject) => {
    waiting.set(++calls, { resolve, reject })
    send({ id: calls, name, args })
})

// ---- What it reads -------------------------------------------------------------------------------------------------------

const half = bits => {
    const exponent = bits >> 10 & 31, fraction = bits & 1023
    const value = exponent ? 2 ** (exponent - 25) * (1024 + fraction) : fraction * 2 ** -24
    return bits >> 15 & 1 ? -value : value
}

// x y z w: 10 bits each for the axis by an octahedron, 12 for the angle
const rotation = bits => {
    let x = (bits & 1023) / 511.5 - 1, y = (bits >> 10 & 1023) / 511.5 - 1
    const z = 1 - Math.abs(x) - Math.abs(y), fold = Math.max(-z, 0), angle = (bits >>> 20) / 4095 * Math.PI / 2
    x += x >= 0 ? -fold : fold
    y += y >= 0 ? -fold : fold
    const sine = Math.sin(angle) / Math.hypot(x, y, z)
    return [x * sine, y * sine, z * sine, Math.cos(angle)]
}

// Three numbers of 8 bits with their signs and an exponent
const triple = bits => {
    const unit = 2 ** ((bits >>> 27) - 15) / 255
    return [0, 1, 2].map(c => (bits >>> 8 * c & 255) * unit * (bits >>> 24 + c & 1 ? -1 : 1))
}

const bytes = readFileSync(file)
const loaded = await call('loadExtSplats', { fileBytes: new Uint8Array(bytes), fileType: 'rad', pathName: file })
const splats = loaded.lodSplats ?? loaded
const [first, second] = splats.extArrays
const tree = splats.extra.lodTree
const arrays = [splats.extra.sh1, splats.extra.sh2, splats.extra.sh3a, splats.extra.sh3b].filter(array => array)
const degree = Math.min(arrays.length, 3)

// Four coefficients in each array, one degree after the other
const sh = i => arrays.flatMap(array => [...array.subarray(4 * i, 4 * i + 4)]).slice(0, degree * (degree + 2)).map(triple)

// A row of Inria's .ply. Of a node that is more than opaque, the opacity is above 1 as Spark draws it: here it grows.
const row = i => {
    const at = 4 * i, words = new Float32Array(first.buffer, 16 * i, 3), code = half(first[at + 3] & 65535)
    const d = Math.min(4 * code - 3, 5), growth = tree && code > 1 ? (d * d - 1) / Math.E / 3 : 0
    const alpha = Math.min(Math.max(code, 1e-6), 1 - 1e-6), [x, y, z, w] = rotation(second[at + 3])
    const rgb = [second[at] & 65535, second[at] >>> 16, second[at + 1] & 65535].map(half)
    const scale = [second[at + 1] >>> 16, second[at + 2] & 65535, second[at + 2] >>> 16].map(half)
    const rest = sh(i)
    return [...words, ...rgb.map(c => (c - 0.5) / 0.28209479177387814), ...[0, 1, 2].flatMap(c => rest.map(k => k[c])),
        Math.log(alpha / (1 - alpha)), ...scale.map(s => s + growth), w, x, y, z]
}

const write = (path, indices) => {
    const rest = 3 * degree * (degree + 2), names = ['x', 'y', 'z', 'f_dc_0', 'f_dc_1', 'f_dc_2',
        ...Array.from({ length: rest }, (_, k) => `f_rest_${k}`), 'opacity', 'scale_0', 'scale_1', 'scale_2', 'rot_0',
        'rot_1', 'rot_2', 'rot_3']
    const head = ['ply', 'format binary_little_endian 1.0', `element vertex ${indices.length}`,
        ...names.map(name => `property float ${name}`), 'end_header', ''].join('\n')
    const body = new Float32Array(indices.length * names.length)
    indices.forEach((i, k) => body.set(row(i), k * names.length))
    writeFileSync(path, Buffer.concat([Buffer.from(head), Buffer.from(body.buffer)]))
    console.log(`${indices.length} of ${splats.numSplats}, SH degree ${degree}`)
}

const all = Array.from({ length: splats.numSplats }, (_, i) => i)
const children = i => tree ? tree[4 * i + 2] & 65535 : 0

if (command === 'decode') {
    write(rest[0], all.filter(i => !children(i)))
} else {
    const [x, y, z] = rest[1].split(',').map(Number)
    const { lodId } = await call('initLodTree', { numSplats: splats.numSplats, lodTree: tree.slice() })
    const viewToObjectCols = [1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 0, x, y, z, 1]      // it looks along +z, y down
    const { keyIndices, chunks } = await call('traverseLodTrees', { maxSplats: Number(rest[0]), pixelScaleLimit: 1e-4,
        instances: { a: { lodId, viewToObjectCols, lodScale: 1, behindFoveate: 1, coneFoveate: 1, coneFov0: 0, coneFov: 0 } } })
    const { indices, numSplats } = keyIndices.a
    const drawn = Array.from(indices.subarray(0, numSplats)), parent = new Int32Array(splats.numSplats).fill(-1)
    all.forEach(i => { for (let k = 0; k < children(i); k++) parent[tree[4 * i + 3] + k] = i })
    const isDrawn = new Set(drawn)
    const covers = i => { let n = 0; for (; i >= 0; i = parent[i]) n += isDrawn.has(i); return n }
    const once = all.filter(i => !children(i)).every(i => covers(i) === 1)
    console.log(once ? 'each leaf once' : 'FAIL: a leaf twice, or not at all', `chunks ${chunks.length}`)
    write(rest[2], drawn)
    process.exitCode = once ? 0 : 1
}
