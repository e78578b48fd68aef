// Reads scene files with the reader of Spark (the npm package @sparkjsdev/spark), without a browser.
// node spark.mjs MODULES decode FILE.rad OUT.ply: writes all Gaussians of a file, or the leaves if it has a tree of
// levels of detail.
// node spark.mjs MODULES cut FILE [SPLATS VIEW OUT.ply]...: writes the tree nodes that Spark would draw from a view, at
// most SPLATS. VIEW is a position X,Y,Z, optionally with the camera's axes.
import { readFileSync, writeFileSync } from 'node:fs'

const [modules, command, file, ...rest] = process.argv.slice(2)
const source = readFileSync(`${modules}/@sparkjsdev/spark/dist/spark.module.js`, 'utf8')

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

const half = bits => {
    const exponent = bits >> 10 & 31, fraction = bits & 1023
    const value = exponent ? 2 ** (exponent - 25) * (1024 + fraction) : fraction * 2 ** -24
    return bits >> 15 & 1 ? -value : value
}

// Unpacks a quaternion x, y, z, w from 32 bits: 10 bits for each octahedral coordinate of its axis, 12 bits for its
// angle.
const rotation = bits => {
    let x = (bits & 1023) / 511.5 - 1, y = (bits >> 10 & 1023) / 511.5 - 1
    const z = 1 - Math.abs(x) - Math.abs(y), fold = Math.max(-z, 0), angle = (bits >>> 20) / 4095 * Math.PI / 2
    x += x >= 0 ? -fold : fold
    y += y >= 0 ? -fold : fold
    const sine = Math.sin(angle) / Math.hypot(x, y, z)
    return [x * sine, y * sine, z * sine, Math.cos(angle)]
}

const triple = bits => {
    const unit = 2 ** ((bits >>> 27) - 15) / 255
    return [0, 1, 2].map(c => (bits >>> 8 * c & 255) * unit * (bits >>> 24 + c & 1 ? -1 : 1))
}

const bytes = readFileSync(file)
const loaded = await call('loadExtSplats', { fileBytes: new Uint8Array(bytes), fileType: file.split('.').pop(), pathName: file,
    lod: file.endsWith('.rad') ? undefined : 'quality' })
const splats = loaded.lodSplats ?? loaded
const [first, second] = splats.extArrays
const tree = splats.extra.lodTree
const arrays = [splats.extra.sh1, splats.extra.sh2, splats.extra.sh3a, splats.extra.sh3b].filter(array => array)
const degree = Math.min(arrays.length, 3)

const sh = i => arrays.flatMap(array => [...array.subarray(4 * i, 4 * i + 4)]).slice(0, degree * (degree + 2)).map(triple)

const row = (i, opacity) => {
    const at = 4 * i, words = new Float32Array(first.buffer, 16 * i, 3)
    const alpha = Math.min(Math.max(opacity, 1e-6), 1 - 1e-6), [x, y, z, w] = rotation(second[at + 3])
    const rgb = [second[at] & 65535, second[at] >>> 16, second[at + 1] & 65535].map(half)
    const scale = [second[at + 1] >>> 16, second[at + 2] & 65535, second[at + 2] >>> 16].map(half)
    const rest = sh(i)
    return [...words, ...rgb.map(c => (c - 0.5) / 0.28209479177387814), ...[0, 1, 2].flatMap(c => rest.map(k => k[c])),
        Math.log(alpha / (1 - alpha)), ...scale, w, x, y, z]
}

// Returns the Gaussians that replace a tree node. Spark draws a node with opacity A above 1 as 1 - (1 - e^(-z^2 /
// 2))^A, like A opaque Gaussians at one place.
const rows = i => {
    const code = half(first[4 * i + 3] & 65535), d = Math.min(4 * code - 3, 5)
    if (!tree || code <= 1) return [row(i, code)]
    const stack = Math.min(Math.exp((d * d - 1) / Math.E), 64), whole = Math.floor(stack)
    return [...Array(whole).fill(row(i, 1)), ...(stack > whole ? [row(i, stack - whole)] : [])]
}

const write = (path, indices) => {
    const rest = 3 * degree * (degree + 2), names = ['x', 'y', 'z', 'f_dc_0', 'f_dc_1', 'f_dc_2',
        ...Array.from({ length: rest }, (_, k) => `f_rest_${k}`), 'opacity', 'scale_0', 'scale_1', 'scale_2', 'rot_0',
        'rot_1', 'rot_2', 'rot_3']
    const all = indices.flatMap(rows)
    const head = ['ply', 'format binary_little_endian 1.0', `element vertex ${all.length}`,
        ...names.map(name => `property float ${name}`), 'end_header', ''].join('\n')
    const body = new Float32Array(all.length * names.length)
    all.forEach((values, k) => body.set(values, k * names.length))
    writeFileSync(path, Buffer.concat([Buffer.from(head), Buffer.from(body.buffer)]))
    console.log(`${indices.length} of ${splats.numSplats}, SH degree ${degree}`)
}

const all = Array.from({ length: splats.numSplats }, (_, i) => i)
const children = i => tree ? tree[4 * i + 2] & 65535 : 0

const cut = async (lodId, maxSplats, view, out, parent) => {
    const [eye, right, down, ahead] = [0, 3, 6, 9].map(k => view.slice(k, k + 3)), back = v => v.map(x => -x)
    const fovs = right.length ? { behindFoveate: 0.2, coneFoveate: 0.4, coneFov0: 90, coneFov: 120 }
        : { behindFoveate: 1, coneFoveate: 1, coneFov0: 0, coneFov: 0 }
    const axes = right.length ? [...right, 0, ...back(down), 0, ...back(ahead), 0] : [1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 0]
    const { keyIndices, chunks } = await call('traverseLodTrees', { maxSplats, pixelScaleLimit: 1e-4,
        instances: { a: { lodId, viewToObjectCols: [...axes, ...eye, 1], lodScale: 1, ...fovs } } })
    const drawn = Array.from(keyIndices.a.indices.subarray(0, keyIndices.a.numSplats)), isDrawn = new Set(drawn)
    const covers = i => { let n = 0; for (; i >= 0; i = parent[i]) n += isDrawn.has(i); return n }
    const once = all.filter(i => !children(i)).every(i => covers(i) === 1)
    console.log(once ? 'each leaf once' : 'FAIL: a leaf twice, or not at all', `chunks ${chunks.length}`)
    write(out, drawn)
    return once
}

if (command === 'decode') {
    write(rest[0], all.filter(i => !children(i)))
} else {
    const parent = new Int32Array(splats.numSplats).fill(-1)
    all.forEach(i => { for (let k = 0; k < children(i); k++) parent[tree[4 * i + 3] + k] = i })
    const { lodId } = await call('initLodTree', { numSplats: splats.numSplats, lodTree: tree.slice() })
    for (let k = 0; k + 2 < rest.length; k += 3)
        if (!await cut(lodId, Number(rest[k]), rest[k + 1].split(',').map(Number), rest[k + 2], parent)) process.exitCode = 1
}
