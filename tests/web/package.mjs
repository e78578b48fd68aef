// node package.mjs PACKAGE WORD ARGUMENT...: checks the npm package in the folder PACKAGE. WORD chooses a test.
import assert from 'node:assert/strict'
import { readFileSync, writeFileSync } from 'node:fs'
import { createServer } from 'node:http'
import { resolve } from 'node:path'
import { pathToFileURL } from 'node:url'
import { inflateSync } from 'node:zlib'
import { run } from './words.mjs'

const [folder, word, ...args] = process.argv.slice(2)
const fixsplat = await import(pathToFileURL(resolve(folder, 'fixsplat.js')))
const { hasRelaxed, load, pick, png, render, renderStereo } = fixsplat

// FNV-1a of 64 bits in two halves: the prime is 2^40 + 0x1b3.
function hash(pixels) {
  let high = 0xcbf29ce4, low = 0x84222325
  for (const byte of pixels) {
    const x = (low ^ byte) >>> 0
    const product = x * 0x1b3
    low = product >>> 0
    high = (Math.imul(high, 0x1b3) + (x << 8) + Math.floor(product / 0x100000000)) >>> 0
  }
  return high.toString(16).padStart(8, '0') + low.toString(16).padStart(8, '0')
}

async function refused(source, words = /./, options) {
  await assert.rejects(load(source, options), (error) => {
    assert.equal(error.constructor, Error, error.stack)
    assert.match(error.message, words)
    return true
  })
}

const flipped = (bytes, at) => Uint8Array.from(bytes, (byte, i) => (i === at ? byte ^ 0x55 : byte))
const memoryOf = (scene) => scene.inside[0].c.memory.buffer.byteLength

const modules = { core: { simd: false }, simd: { threads: 1 }, threads: { threads: 2 } }

async function started(scene, module) {
  const { threads = 1 } = modules[module]
  for (let i = 0; scene.threads < threads; i++) {
    assert.ok(i < 1000, 'threads do not start')
    await new Promise((done) => setTimeout(done, 10))
  }
}

const words = {
  async hash(module, camera, options, objects, ...files) {
    const scenes = []
    for (const file of files) scenes.push(await load(file, modules[module]))
    await started(scenes[0], module)
    const placed = scenes.map((scene, i) => ({ scene, ...JSON.parse(objects)[i] }))
    console.log(hash(render(placed, JSON.parse(camera), JSON.parse(options))))
  },

  async stereo(module, file, left, right, text, out) {
    const options = JSON.parse(text)
    const scene = await load(file, modules[module])
    await started(scene, module)
    const eyes = scene.renderStereo(JSON.parse(left), JSON.parse(right), options)
    const row = 4 * options.width
    const rows = (y) => eyes.map((pixels) => new Uint8Array(pixels.buffer, row * y, row))
    writeFileSync(out, Buffer.concat(Array.from({ length: options.height }, (_, y) => rows(y)).flat()))
  },

  async targets(module, file, camera, text, folder) {
    const options = JSON.parse(text)
    const scene = await load(file, modules[module])
    await started(scene, module)
    const frame = (targets, more) => scene.render(JSON.parse(camera), { ...options, ...more, targets })
    const all = frame({ colour: 'premultiplied', coverage: true, depth: true, meanDepth: true, ids: true })
    const { width, height, colour, coverage, ids } = all
    const keys = ['colour', 'coverage', 'depth', 'drawn', 'height', 'ids', 'meanDepth', 'missing', 'width']
    assert.deepEqual(Object.keys(all).sort(), keys)
    assert.deepEqual([all.drawn, all.missing], [256 * Math.ceil(scene.count / 256), 0])
    assert.deepEqual(coverage, Uint8Array.from(colour.filter((_, i) => i % 4 === 3)))
    const units = (code) => (code === 0xffffffff ? Infinity : code / 2 ** (options.depthBits ?? 16))
    const rows = (codes) => Array.from({ length: height }, (_, y) => codes.subarray(width * y, width * (y + 1)))
    const pfm = (codes) =>
      Buffer.concat([
        Buffer.from(`Pf\n${width} ${height}\n-1.0\n`),
        ...rows(codes).reverse().map((row) => Buffer.from(Float32Array.from(row, units).buffer)),
      ])
    writeFileSync(`${folder}/colour.raw`, colour)
    writeFileSync(`${folder}/ids.raw`, Buffer.from(ids.buffer))
    writeFileSync(`${folder}/depth.pfm`, pfm(all.depth))
    writeFileSync(`${folder}/mean.pfm`, pfm(all.meanDepth))

    const { colour: fine } = frame({ colour: 'premultiplied16' })
    assert.ok(fine.every((value, i) => Math.abs(value / 257 - colour[i]) <= 1))
    const { colour: plain } = frame({ colour: true })
    const { colour: coarse } = frame({ colour: 'rgb565' })
    const near = (value, most, i) => Math.abs((255 * value) / most - plain[i]) <= 255 / most
    for (const [i, value] of coarse.entries())
      assert.ok(
        near(value >> 11, 31, 4 * i) && near((value >> 5) & 63, 63, 4 * i + 1) && near(value & 31, 31, 4 * i + 2)
      )
    const { colour: grey } = frame({ colour: true }, { background: 0x404040 })
    assert.deepEqual(frame({ colour: true, backdrop: plain.fill(0x40) }).colour, grey)
    const hidden = frame({ colour: true, coverage: true, occluder: new Uint32Array(width * height) })
    assert.ok(coverage.some(Boolean) && !hidden.coverage.some(Boolean))
  },

  async damage(...files) {
    for (const file of files) {
      const bytes = new Uint8Array(readFileSync(file))
      const before = hash((await load(bytes)).render({}, { width: 64, height: 48 }))
      const isPacked = file.endsWith('.fxs')
      for (let at = 0; at < bytes.length && isPacked; at += at < 600 ? 1 : 331) await refused(flipped(bytes, at))
      for (let end = 0; end < bytes.length; end += end < 600 ? 7 : 4999) await refused(bytes.slice(0, end))
      await refused(new Uint8Array([...bytes.slice(0, 64), ...new Uint8Array(100).fill(255)]))
      assert.equal(hash((await load(bytes)).render({}, { width: 64, height: 48 })), before)
    }
  },

  async memory(module, file) {
    const used = []
    let first = 0
    for (let i = 0; i < 50; i++) {
      const scene = await load(file, modules[module])
      await started(scene, module)
      scene.render(i % 5 ? { eye: [2, -1, -4] } : {}, { width: 320, height: 240 })   // {}: a view is searched
      first ||= memoryOf(scene)
      scene.free()
      globalThis.gc()
      const { heapUsed, external } = process.memoryUsage()
      used.push(heapUsed + external)
    }
    const [before, after] = [used.slice(5, 10), used.slice(45)].map((some) => Math.min(...some))
    assert.ok(after <= 1.05 * before, `${before} bytes, then ${after}`)
    const last = memoryOf(await load(file, modules[module]))
    assert.ok(last <= 1.05 * first, `the module had ${first} bytes, then ${last}`)
  },

  async sources(file) {
    const bytes = readFileSync(file)
    let givenUp
    const server = createServer((request, answer) => {
      if (request.url === '/endless.ply') {
        givenUp = new Promise((done) => answer.on('close', done))
        return answer.write('ply\n')
      }
      if (request.url !== '/a%20scene.fxs') answer.statusCode = 404
      answer.end(bytes)
    }).listen(0, '127.0.0.1')
    await new Promise((done) => server.once('listening', done))
    const base = `http://127.0.0.1:${server.address().port}`
    const copy = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length)
    const sources = [file, pathToFileURL(file), `${base}/a%20scene.fxs`, bytes, copy, new Blob([bytes])]
    for (const source of sources) assert.deepEqual(Buffer.from((await load(source)).packed), bytes)
    assert.equal((await load(`${base}/a%20scene.fxs`)).name, 'a scene.fxs')
    await refused(`${base}/none.fxs`, /404/)
    await refused(`${base}/endless.ply`, /stop/, { progress() { throw new Error('stop') } })
    await givenUp
    server.close()
    server.closeAllConnections()
    await assert.rejects(load(`${base}/a%20scene.fxs`))
    await assert.rejects(load('none.fxs'), /ENOENT/)
    await refused(null)
    await refused([bytes], /no files/)
    await refused(`${base}/100%.fxs`, /100%\.fxs: cannot be reached/)
    await refused(new Uint8Array(0))
    await refused(Buffer.from('GIF89a, and no scene'), /scene/)
    await refused(Buffer.from([0x1f, 0x8b, 8, 0, 1, 2, 3, 4]), /gzip/)
    const huge = 'ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nend_header\n'
    await refused(Buffer.from(huge))
  },

  async misuse(file, ply) {
    const scene = await load(file)
    const size = { width: 64, height: 48 }
    const wrong = (words, ...frame) => assert.throws(() => render(...frame), words)
    wrong(/no objects/, [])
    wrong(/pixels/, [{ scene }], {}, { width: 0, height: 10 })
    wrong(/pixels/, [{ scene }], {}, { width: 1.5, height: 10 })
    wrong(/field of view of 200/, [{ scene }], { fov: 200 }, size)
    wrong(/looks nowhere/, [{ scene }], { eye: [1, 1, 1], look: [1, 1, 1] }, size)
    const pinhole = { fx: 100, rotation: [[1, 0, 0], [0, 1, 0], [0, 0, 1]], position: [0, 0, 0] }
    wrong(/focal length of 0 pixels/, [{ scene }], { ...pinhole, fx: 0 }, size)
    wrong(/not a rotation/, [{ scene }], { ...pinhole, rotation: [[9, 0, 0], [0, 1, 0], [0, 0, 1]] }, size)
    wrong(/scale/, [{ scene, scale: 0 }], {}, size)
    wrong(/tint/, [{ scene, tint: [9, 1, 1] }], {}, size)
    wrong(/crops: expected at most 8/, [{ scene, crops: Array(9).fill({ low: [0, 0, 0], high: [1, 1, 1] }) }], {}, size)
    wrong(/rotation: expected 9/, [{ scene }], { ...pinhole, rotation: [[1, 0], [0, 1]] }, size)
    wrong(/expected a number/, [{ scene }], { fov: [50] }, size)
    wrong(/expected a number/, [{ scene, id: Array(5000).fill(1) }], {}, size)
    for (const id of [-1, NaN, 2 ** 32 - 1, 2 ** 32 + 5])
      wrong(/id: expected 0 to 4294967294/, [{ scene, id }], {}, size)
    wrong(/targets: expected those of one eye/, [{ scene }], {}, { ...size, targets: Array(12).fill({ colour: true }) })
    wrong(/eye: expected 3/, [{ scene }], { eye: [1, 2] }, size)
    wrong(/up: expected 3/, [{ scene }], { up: 'up' }, size)
    wrong(/memory/, [{ scene }], {}, { ...size, maxMemory: 1000 })
    wrong(/range/, [{ scene }], {}, { ...size, shDegree: 7 })
    for (const budget of [-1, 1.5, NaN, '9']) wrong(/budget .*: expected a number/, [{ scene }], {}, { ...size, budget })
    for (const detail of [-1, NaN, 16385]) wrong(/detail .*: expected pixels/, [{ scene }], {}, { ...size, detail })
    const wanted = (targets) => ({ ...size, targets })
    wrong(/depths: expected one of colour, coverage/, [{ scene }], {}, wanted({ depths: true }))
    wrong(/rgb: expected one of rgba8/, [{ scene }], {}, wanted({ colour: 'rgb' }))
    wrong(/target/, [{ scene }], {}, wanted({}))
    wrong(/occluder: expected 3072 numbers/, [{ scene }], {}, wanted({ depth: true, occluder: new Uint32Array(9) }))
    wrong(/depthBits 29: expected 1 to 28/, [{ scene }], {}, { ...wanted({ depth: true }), depthBits: 29 })
    const most = { width: 16384, height: 16384 }
    wrong(/memory/, [{ scene }], {}, { ...most, targets: { colour: 'premultiplied16', depth: true, ids: true } })
    const kinds = (Kind, words, run) =>
      assert.throws(run, ({ constructor, message }) => {
        assert.equal(constructor, Kind, message)
        assert.match(message, words)
        return true
      })
    for (const crops of [{}, null, 1, 'x', [null], [1]])
      kinds(TypeError, /^object 0: crops: expected a list of boxes$/, () => render([{ scene, crops }], {}, size))
    wrong(/low: expected 3 numbers/, [{ scene, crops: [{}] }], {}, size)
    for (const other of [null, undefined, {}, 5, 'scene.fxs'])
      kinds(TypeError, /^object 1: scene: expected what/, () => render([{ scene }, { scene: other }], {}, size))
    for (const object of [null, undefined, 7]) kinds(TypeError, /^object 0: expected/, () => render([object], {}, size))
    for (const list of [null, undefined, scene, 5]) kinds(TypeError, /^objects: expected/, () => render(list, {}, size))
    for (const other of [null, 5]) {
      kinds(TypeError, /^camera: expected an object$/, () => scene.render(other, size))
      kinds(TypeError, /^camera: expected an object$/, () => scene.renderStereo({}, other, size))
      kinds(TypeError, /^options: expected an object$/, () => scene.render({}, other))
      kinds(TypeError, /^targets: expected an object$/, () => scene.render({}, { ...size, targets: other }))
    }
    for (const name of ['background', 'shDegree', 'maxMemory'])
      kinds(TypeError, new RegExp(`^${name} NaN: expected a number`), () => scene.render({}, { ...size, [name]: NaN }))
    for (const [x, y] of [[NaN, 0], [0, NaN], [-1, 0], [0, 48], [64, 0], [Infinity, 0], [1e99, 0]])
      kinds(RangeError, /^pick: .*: expected a pixel of a picture of 64 x 48$/, () => scene.pick(x, y, {}, size))
    for (const x of [undefined, null, '1', {}])
      kinds(TypeError, /^pick: .*: expected two numbers$/, () => scene.pick(x, 0, {}, size))
    assert.deepEqual(scene.pick(30.75, 20.25, {}, size), scene.pick(30, 20, {}, size))
    const rejected = (Kind, words, promise) =>
      assert.rejects(promise, ({ constructor, message }) => constructor === Kind && words.test(message))
    const some = new Uint8Array(16)
    for (const [width, height] of [[NaN, -1], [0, 4], [1.5, 1], [undefined, 2], ['2', 2], [Infinity, 1]])
      await rejected(RangeError, /^png: .* pixels: expected 1 or more each$/, png(some, width, height))
    for (const [width, height] of [[1, 1], [20, 20], [1e9, 1e9]])
      await rejected(RangeError, /^png: 16 bytes of pixels: .* have /, png(some, width, height))
    for (const part of [new Uint8Array(4), new Uint8Array(12)])
      await rejected(RangeError, /^png: .* expected 8/, png((async function* () { yield part })(), 1, 2))
    const rows = [[0, 0], [-1, 2], [40, 9], [0.5, 1]]
    for (const some of rows) assert.throws(() => scene.render({}, { ...size, rows: some }), /expected the first row/)
    for (const pixels of [null, undefined, 'x', [0, 0, 0, 0]])
      await rejected(TypeError, /^png: pixels: expected/, png(pixels, 1, 1))
    await rejected(TypeError, /^options: expected an object$/, load(file, null))
    for (const source of [undefined, 5, {}]) await refused(source, /^load: expected an address/)
    assert.throws(() => scene.renderStereo({}, { fov: 200 }, size), /field of view of 200/)
    assert.throws(() => scene.renderStereo({}, {}, { ...size, maxMemory: 1000 }), /memory/)
    assert.throws(() => scene.renderStereo({}, {}, { ...size, targets: [{ colour: true }] }), /those of two eyes/)
    assert.deepEqual(scene.render({}, { ...size, maxMemory: 2 ** 32 + 1000 }), scene.render({}, size))
    wrong(/other `simd`/, [{ scene }, { scene: await load(file, { simd: false }) }], {}, size)
    await refused(ply, /expected one of/, { profile: 'huge' })
    await refused(ply, /limit of 699/, { maxGaussians: 699 })
    assert.equal(scene.render({}, size).length, 4 * 64 * 48)
    scene.free()
    scene.free()
    assert.throws(() => scene.render({}, size), /freed/)
  },

  async noRoom(file) {
    const size = { width: 16384, height: 16384 }
    const most = { colour: 'premultiplied16', coverage: true, depth: true, ids: true }
    const said = async (run, words) => {
      const start = performance.now()
      assert.throws(run, ({ message }) => words.test(message) && !message.includes('\n'))
      assert.ok(performance.now() - start < 2000)
    }
    const own = globalThis.Uint8ClampedArray
    globalThis.Uint8ClampedArray = class extends own {
      constructor(...given) {
        if ((given[0].length ?? given[0]) > 1e9) throw new RangeError('Array buffer allocation failed')
        super(...given)
      }
    }
    const { load } = await import(`${pathToFileURL(resolve(folder, 'fixsplat.js'))}?limited`)
    globalThis.Uint8ClampedArray = own
    const scene = await load(file, { threads: 1 })
    await said(() => scene.render({}, size), /^16384 x 16384 pixels: there is no memory for their 1074 MB$/)
    await said(() => scene.render({}, { ...size, targets: most }), /memory/)
    assert.equal(scene.render({}, { width: 64, height: 48 }).length, 4 * 64 * 48)
  },

  async budgets(file) {
    const scene = await load(file)
    assert.equal(scene.levels, true)
    let before = 0
    for (const budget of [1, 1000, 5000, 2 ** 32, undefined]) {
      const options = { width: 320, height: 200, budget }
      const { drawn, missing } = scene.render({}, { ...options, targets: { colour: true } })
      assert.ok(drawn > before && drawn <= Math.max(256, budget ?? Infinity) && missing === 0, `${budget}: ${drawn}`)
      before = budget === 2 ** 32 ? 0 : drawn
      const found = scene.pick(160, 100, {}, options)
      const { ids } = scene.render({}, { ...options, targets: { ids: true } })
      assert.equal(found?.gaussian, ids[2 * (100 * 320 + 160) + 1])
    }
    assert.equal(before, 256 * Math.ceil(scene.count / 256))
  },

  async parts(address, camera, options) {
    const scene = await load(address)
    assert.equal(scene.paged, true)
    await scene.complete(JSON.parse(camera), JSON.parse(options))
    console.log(hash(scene.render(JSON.parse(camera), JSON.parse(options))))
    scene.free()
  },

  async pick(file, camera, options, x, y) {
    const found = pick(+x, +y, [{ scene: await load(file) }], JSON.parse(camera), JSON.parse(options))
    console.log(found ? `${found.gaussian} ${found.depth.toFixed(4)}` : 'nothing')
  },

  async png(file) {
    const pixels = (await load(file)).render({}, { width: 61, height: 47 })
    const bytes = Buffer.from(await png(pixels, 61, 47))
    const length = bytes.readUInt32BE(33)
    const rows = inflateSync(bytes.subarray(41, 41 + length))
    for (let y = 0; y < 47; y++) {
      const row = Buffer.from([0, ...pixels.subarray(244 * y, 244 * (y + 1))])
      assert.deepEqual(rows.subarray(245 * y, 245 * (y + 1)), row)
    }
  },

  async relaxed() {
    console.log(hasRelaxed)
  },

  // Prints how often a WebAssembly file has the bytes of the instruction i16x8.q15mulr_sat_s. The argument is the file.
  async products(file) {
    console.log(readFileSync(file).toString('latin1').split('\xfd\x82\x01').length - 1)
  },

  async pack(file, profile, module) {
    process.stdout.write((await load(file, { profile, ...modules[module] })).packed)
  },

  async speed(module, file, camera, width, height) {
    const scene = await load(file, modules[module])
    await started(scene, module)
    const times = []
    const end = performance.now() + 3000
    for (let i = 0; i < 12 && (i < 2 || performance.now() < end); i++) {
      const start = performance.now()
      scene.render(JSON.parse(camera), { width: +width, height: +height })
      times.push(performance.now() - start)
    }
    console.log(Math.min(...times).toFixed(1))
  },
}

await run(words, word, args)
