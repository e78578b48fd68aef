// node paging.mjs PACKAGE SCENE HASH: checks scenes that are streamed from a server. HASH is the hash of the picture
// that the command-line program draws.
import assert from 'node:assert/strict'
import { readFileSync } from 'node:fs'
import { resolve } from 'node:path'
import { pathToFileURL } from 'node:url'
import { serveRanges } from './ranges.mjs'

const [folder, file, wanted] = process.argv.slice(2)
const { load, foresee } = await import(pathToFileURL(resolve(folder, 'fixsplat.js')))
const CAMERA = { eye: [2, -1, -4] }
const OPTIONS = { width: 200, height: 150, budget: 6000 }
const GAUSSIANS = 256

function hash(pixels) {
  let h = 0xcbf29ce484222325n
  for (const byte of pixels) h = BigInt.asUintN(64, (h ^ BigInt(byte)) * 0x100000001b3n)
  return h.toString(16).padStart(16, '0')
}

const draw = (scene, camera = CAMERA, options = OPTIONS) =>
  scene.render(camera, { ...options, targets: { colour: true } })

async function exact(scene) {
  await scene.complete(CAMERA, OPTIONS)
  const { missing, colour } = draw(scene)
  assert.deepEqual([missing, hash(colour)], [0, wanted])
}

async function served(options, run, paging = {}, more = {}) {
  const server = await serveRanges(file, options)
  let scene
  try {
    scene = await load(server.url, { threads: 1, ...more, paging })
    await run(scene, server)
  } finally {
    scene?.free()
    server.close()
  }
}

const refused = (options, words, paging) => assert.rejects(served(options, () => {}, paging), words)

async function fails(change, words, paging = {}) {
  const said = []
  await served({}, async (scene, server) => {
    const before = hash(draw(scene).colour)
    change(server)
    await assert.rejects(scene.complete(CAMERA, OPTIONS), words)
    assert.match(scene.failure.message, words)
    assert.equal(said.length, 1)
    assert.ok(draw(scene).missing > 0 && before)
  }, { changed: (error) => error && said.push(error), requests: 1, ...paging })
}

const tests = {
  async 'the first picture is there before the file, and the last has the bytes of the command'() {
    const steps = []
    await served({}, async (scene, server) => {
      assert.ok(scene.paged && scene.levels && server.sent < server.size / 2, `${server.sent} of ${server.size}`)
      assert.throws(() => scene.packed, /only parts/)
      const first = draw(scene)
      assert.ok(first.missing > 0 && first.drawn >= GAUSSIANS)
      assert.notEqual(hash(first.colour), wanted)
      for (let frame; (frame = draw(scene)).missing; await scene.complete(CAMERA, OPTIONS)) steps.push(frame.missing)
      await exact(scene)
      assert.equal(foresee([{ scene }], CAMERA, OPTIONS), 0)
    })
    assert.ok(steps.length >= 1)
  },

  async 'as many threads, without simd128, and beside another scene'() {
    for (const module of [{ threads: 2 }, { simd: false }]) await served({}, exact, {}, module)
    await served({}, async (scene) => {
      const whole = await load(file, { threads: 1 })
      const objects = [{ scene }, { scene: whole, translation: [30, 0, 0] }]
      while (foresee(objects, CAMERA, OPTIONS)) await new Promise((done) => setTimeout(done, 5))
      await exact(scene)
    })
  },

  async 'pictures draw nearer as parts come; what has come is told'() {
    let told = 0
    await served({ rate: 3e5 }, async (scene, server) => {
      const missing = []
      while (!missing.length || missing.at(-1)) {
        missing.push(draw(scene).missing)
        await new Promise((done) => setTimeout(done, 20))
        assert.ok(missing.length < 1000)
      }
      assert.ok(missing.length > 3 && told > 0, `${missing}, ${told}`)
      assert.equal(hash(draw(scene).colour), wanted)
      const { requests } = server
      draw(scene)
      assert.equal(server.requests, requests)
    }, { changed: (error) => (told += !error) })
  },

  async 'without paging, from a server without ranges, and of another version: the whole file'() {
    const whole = async (scene) => {
      assert.equal(scene.paged, false)
      assert.equal(hash(draw(scene).colour), wanted)
      assert.deepEqual(Buffer.from(scene.packed), readFileSync(file))
    }
    const short = { headers: { 'content-length': null }, bytes: () => Buffer.from('x') }
    await served({}, whole, false)
    await served({ faults: () => ({ whole: true }) }, async (scene, server) => {
      await whole(scene)
      assert.equal(server.requests, 1)
    })
    await served({ faults: ({ first }) => (first === 0 ? { headers: { 'content-encoding': 'identity' } } : {}) }, whole)
    await served({ faults: (_, { headers }) => (headers.range ? short : {}) }, whole)
    const none = { status: 416, bytes: () => Buffer.alloc(0) }
    await served({ faults: (_, { headers }) => (headers.range ? none : {}) }, whole)
  },

  async 'small pools: what was used longest ago goes, what is needed comes again'() {
    await served({}, async (scene, server) => {
      const most = { ...OPTIONS, budget: 1e6 }
      await assert.rejects(async () => draw(scene, CAMERA, most), /budget 1000000: the pool has room/)
      const cameras = [0, 1, 2, 3, 4, 5].map((i) => ({ eye: [5 * Math.cos(i), i - 3, 5 * Math.sin(i)] }))
      const large = { ...OPTIONS, budget: 24000 }
      const sent = []
      const hashes = []
      for (let i = 0; i < 18; i++) {
        await scene.complete(cameras[i % 6], large)
        const { missing, colour } = draw(scene, cameras[i % 6], large)
        assert.equal(missing, 0)
        assert.equal((hashes[i % 6] ??= hash(colour)), hash(colour))
        sent.push(server.sent)
      }
      assert.ok(sent[17] > sent[11] && sent[11] > sent[5], sent)
      await exact(scene)
      const { sent: before } = server
      await exact(scene)
      assert.equal(server.sent, before)
    }, { memory: 1 })
  },

  async 'what lies ahead comes after what is seen'() {
    await served({}, async (scene, server) => {
      await scene.complete(CAMERA, OPTIONS)
      const ahead = { eye: [1, -1, -3] }
      const { requests } = server
      for (let i = 0; i < 500 && scene.foresee(ahead, OPTIONS); i++) await new Promise((done) => setTimeout(done, 5))
      assert.ok(server.requests > requests)
      assert.equal(draw(scene, ahead).missing, 0)
    })
  },

  async 'without `fetch` a picture asks for nothing'() {
    await served({}, async (scene, server) => {
      while (scene.foresee(CAMERA, OPTIONS)) await new Promise((done) => setTimeout(done, 5))
      const ahead = { eye: [-3, 1, 2] }
      const look = () => scene.render(ahead, { ...OPTIONS, fetch: false, targets: { depth: true } }).missing
      const { requests } = server
      assert.ok(look() > 0)
      await new Promise((done) => setTimeout(done, 50))
      assert.equal(server.requests, requests)
      scene.foresee(ahead, OPTIONS)
      await new Promise((done) => setTimeout(done, 50))
      assert.ok(server.requests > requests)
    })
  },

  async 'a file that changes: words, and no picture of both'() {
    const words = /has changed on its server/
    await fails((server) => (server.tag = '"two"'), words)
    await fails((server) => Object.assign(server, { tag: undefined, modified: 'Tue, 02 Jan 2024 00:00:00 GMT' }), words)
    await fails((server) => (server.faults = () => ({ status: 416 })), words)
    await fails((server) => (server.faults = () => ({ whole: true })), words)
  },

  async 'damage: found by the checksum, asked for once more, then words'() {
    const hurt = (bytes) => Buffer.from(bytes).fill(7, bytes.length >> 1, (bytes.length >> 1) + 9)
    const late = ({ first }) => (first > 1e5 ? { bytes: hurt } : {})
    await fails((server) => (server.faults = late), /is damaged|damaged:/)
    let once = 0
    const last = ({ first, count }) => (count > 8 && once++ < 1 ? { bytes: hurt } : {})
    await served({ faults: last }, async (scene) => {
      await exact(scene)
      assert.ok(once > 0)
    }, { requests: 1 })
    for (let at = 0; at < 192; at += 5) {
      const flip = (bytes, first) => (first === 0 ? Buffer.from(bytes).fill(bytes[at] ^ 0x55, at, at + 1) : bytes)
      const all = (_, { headers }) => (headers.range ? { bytes: flip } : { status: 404 })
      await refused({ faults: all }, /damaged|\.fxs|404/)
    }
    await refused({ faults: ({ first }) => (first > 192 ? { bytes: hurt } : {}) }, /damaged/)
  },

  async 'answers that are not what was asked for'() {
    const other = { headers: { 'content-range': 'bytes 0-9/10' } }
    await fails((server) => (server.faults = () => other), /other bytes than/)
    const more = (bytes) => Buffer.concat([bytes, Buffer.alloc(100)])
    const longer = { headers: { 'content-length': null }, bytes: more }
    await fails((server) => (server.faults = () => longer), /more bytes than/)
    await fails((server) => (server.faults = () => ({ status: 403 })), /answered 403/)
    const size = readFileSync(file).length
    const short = ({ first, end }) => ({ headers: { 'content-range': `bytes ${first}-${end - 1}/${size - 1}` } })
    await refused({ faults: short }, /cut short: .* expected/)
  },

  async 'answers that break off or fail a few times are asked for again; then words'() {
    let count = 0
    const sometimes = () => (++count % 3 === 0 ? { cut: 1000 } : count % 5 === 0 ? { status: 503 } : {})
    await served({}, async (scene, server) => {
      server.faults = sometimes
      await exact(scene)
      assert.ok(count > 5)
    })
    await fails((server) => (server.faults = () => ({ cut: 1000 })), /broke off/)
    await fails((server) => server.close(), /cannot be reached any more/)
  },

  async 'a silent server: words, at opening and later'() {
    await fails((server) => (server.faults = () => ({ silent: true })), /silent for 0.3 seconds/, { silence: 300 })
    await refused({ faults: ({ count }) => ({ silent: count > 1 }) }, /silent for 0.3/, { silence: 300 })
    await refused({ faults: () => ({ silent: true }) }, /silent for 0.3/, { silence: 300 })
  },

  async 'a server that sends two bytes at a time: told, given up, and ended by a signal'() {
    const slow = { faults: ({ count }) => ({ drip: count > 1 }) }
    const told = []
    const options = { silence: 300, progress: ({ bytes }) => told.push(bytes) }
    const words = /^Error: scene\.fxs: the server (sent \d+ bytes in|was silent for) 0\.3 seconds$/
    await assert.rejects(served(slow, () => {}, {}, options), words)
    assert.ok(told.length && told[0] > 0 && told[0] < 1000, `${told}`)
    await fails((server) => (server.faults = () => ({ drip: true })), /0\.3 seconds/, { silence: 300 })
    const end = new AbortController()
    setTimeout(() => end.abort(new Error('enough')), 100)
    const start = performance.now()
    await assert.rejects(served(slow, () => {}, {}, { signal: end.signal }), /^Error: enough$/)
    assert.ok(performance.now() - start < 2000)
    const later = new AbortController()
    await served({}, async (scene) => {
      later.abort()
      await exact(scene)
    }, {}, { signal: later.signal })
  },

  async 'without ETag and Last-Modified'() {
    const without = { headers: { etag: null, 'last-modified': null } }
    await served({ faults: () => without }, exact)
  },

  async 'freed while parts are on their way; twenty scenes are given back'() {
    let bytes = 0
    for (let i = 0; i < 20; i++)
      await served({}, async (scene) => {
        draw(scene)
        const { buffer } = scene.inside[0].c.memory
        if (i < 3) bytes = buffer.byteLength
        assert.ok(buffer.byteLength <= bytes, `${buffer.byteLength} bytes, then ${bytes}`)
        const arrival = scene.complete(CAMERA, OPTIONS)
        scene.free()
        await assert.rejects(arrival, /freed/)
        assert.throws(() => draw(scene), /freed/)
      })
  },
}

const only = new RegExp(process.env.ONLY ?? '')
for (const [name, test] of Object.entries(tests).filter(([name]) => only.test(name)))
  try {
    const start = performance.now()
    await test()
    console.log(`ok paging: ${name}`, process.env.TIMES ? Math.round(performance.now() - start) : '')
  } catch (error) {
    console.log(`FAIL paging: ${name}: ${error.stack}`)
    process.exitCode = 1
  }
process.exit()
