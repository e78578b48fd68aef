// node moving_parts.mjs PACKAGE SCENE LEVELS: checks a moving scene that is streamed from a server. SCENE has more than
// 256 chunks (256 Gaussians each), and most of them are not seen at the start. LEVELS is the same scene with levels of
// detail.
import assert from 'node:assert/strict'
import { readFileSync } from 'node:fs'
import { resolve } from 'node:path'
import { pathToFileURL } from 'node:url'
import { serveRanges } from './ranges.mjs'

const [folder, file, levels] = process.argv.slice(2)
const { load, render } = await import(pathToFileURL(resolve(folder, 'fixsplat.js')))
const CAMERA = { eye: [2, -1, -4] }
const SIZE = { width: 200, height: 150 }
const CHUNK = 256
const LEAST = 1e5               // bytes of the file in front of which a change hits the tables

const pause = (ms) => new Promise((done) => setTimeout(done, ms))
const whole = await load(file, { threads: 1 })
const at = (time) => ({ ...SIZE, time })
const same = (scene, time) =>
  assert.deepEqual(scene.render(CAMERA, at(time)), whole.render(CAMERA, at(time)), `${time} s`)
const { duration } = whole
const times = [0, 0.1, 0.35, 0.5, 0.9, 1.25].map((share) => share * duration)

async function served(options, run, paging = {}, path = file) {
  const server = await serveRanges(path, options)
  let scene
  try {
    scene = await load(server.url, { threads: 1, paging })
    await run(scene, server)
  } finally {
    scene?.free()
    server.close()
  }
}

async function exact(scene, time) {
  await scene.complete(CAMERA, at(time))
  same(scene, time)
}

async function fetched(scene, from, to) {
  for (let i = 0; scene.prefetch(from, to); i++) {
    assert.ok(i < 1000, 'what was asked for does not come')
    await pause(5)
  }
}

const tests = {
  async 'the facts, and the bytes of the whole file at each time'() {
    assert.ok(whole.duration > 0 && whole.rate > 0 && whole.loops && !whole.paged)
    await served({}, async (scene, server) => {
      assert.ok(scene.paged && !scene.levels && server.sent < server.size / 2, `${server.sent} of ${server.size}`)
      const facts = ({ count, duration, rate, loops, low, high }) => [count, duration, rate, loops, low, high]
      assert.deepEqual(facts(scene), facts(whole))
      for (const time of [...times, -0.3, 1e6, ...times]) await exact(scene, time)
      assert.ok(whole.render(CAMERA, { ...at(0), targets: { colour: true } }).drawn < whole.count / 2)
    })
  },

  async 'what lies ahead in time comes early, and stays'() {
    await served({}, async (scene, server) => {
      await exact(scene, 0)
      await fetched(scene, 0.5 * duration, 0.7 * duration)
      const { sent } = server
      for (let time = 0.5 * duration; time < 0.7 * duration; time += duration / 60) same(scene, time)
      await fetched(scene, 0.95 * duration, 1.05 * duration)
      same(scene, 1.02 * duration)
      await pause(50)
      assert.ok(server.sent > sent && server.sent < server.size)
      assert.throws(() => scene.prefetch(0, NaN), /time NaN: expected seconds/)
      await fetched(scene, -1e6, 1e6)
    })
    assert.equal(whole.prefetch(0, 1), 0)
  },

  async 'a small pool: what was is dropped for what comes'() {
    await served({}, async (scene, server) => {
      const chunks = Math.ceil(scene.count / CHUNK)
      assert.ok(chunks > 256, `${chunks} chunks`)
      for (let i = 0; i < 90; i++) {
        await exact(scene, (i * duration) / 30)
        scene.prefetch((i * duration) / 30, ((i + 3) * duration) / 30)
      }
      const { sent } = server
      await exact(scene, duration / 2)
      assert.ok(sent > server.size, `${sent} of ${server.size}`)
    }, { memory: 1 })
  },

  async 'levels of detail: few chunks at first, a budget, and the bytes of the whole file'() {
    const coarse = await load(levels, { threads: 1 })
    const budget = { budget: coarse.count / 8 }
    const drawn = (scene, time, more) => scene.render(CAMERA, { ...at(time), ...more })
    await served({}, async (scene, server) => {
      assert.deepEqual([scene.paged, scene.levels, scene.duration], [true, true, duration])
      assert.ok(server.sent < server.size / 3, `${server.sent} of ${server.size}`)
      for (const time of times) {
        await scene.complete(CAMERA, { ...at(time), ...budget })
        assert.deepEqual(drawn(scene, time, budget), drawn(coarse, time, budget), `${time} s`)
      }
      assert.ok(server.sent < server.size, `${server.sent} of ${server.size}`)
      await fetched(scene, 0.2 * duration, 0.4 * duration)
      const none = { budget: 0 }
      await scene.complete(CAMERA, { ...at(times[2]), ...none })
      assert.deepEqual(drawn(scene, times[2], none), drawn(coarse, times[2], none))
    }, {}, levels)
    coarse.free()
  },

  async 'objects at times of their own'() {
    await served({}, async (scene) => {
      const list = (own) => [{ scene: own, time: 0.2 }, { scene: whole, time: 0.5, translation: [1, 0, 0] }]
      const [a, b] = [render(list(scene), CAMERA, at(0.1)), render(list(whole), CAMERA, at(0.1))]
      await scene.complete(CAMERA, at(0.1 + 0.2))
      assert.deepEqual(render(list(scene), CAMERA, at(0.1)), b)
      assert.ok(a.length === b.length)
      assert.deepEqual(render([{ scene: whole, time: 0.3 }], CAMERA, at(0.2)), whole.render(CAMERA, at(0.5)))
      assert.throws(() => whole.render(CAMERA, at(2e6)), /time 2000000: expected seconds, within 1000000/)
      assert.throws(() => render([{ scene: whole, time: 'x' }], CAMERA, SIZE), /time x: expected seconds/)
    })
  },

  async 'damage: told at opening and later'() {
    const hurt = (bytes) => Buffer.from(bytes).fill(7, bytes.length >> 1, (bytes.length >> 1) + 9)
    const refused = (faults) => assert.rejects(served({ faults }, () => {}), /damaged/)
    await refused(({ first }) => (first > 192 && first < LEAST ? { bytes: hurt } : {}))
    await refused(({ first }) => (first > 192 ? { bytes: hurt } : {}))
    let once = 0
    const late = ({ first }) => (first > LEAST && once++ < 1 ? { bytes: hurt } : {})
    await served({ faults: late }, (scene) => exact(scene, duration / 2))
    assert.ok(once > 1)
    await served({}, async (scene, server) => {
      server.faults = () => ({ bytes: hurt })
      await assert.rejects(scene.complete(CAMERA, at(duration / 2)), /damaged/)
      assert.match(scene.failure.message, /damaged/)
      assert.ok(scene.render(CAMERA, { ...at(duration / 2), targets: { colour: true } }).missing > 0)
    })
  },

  async 'from a server without ranges: the whole file'() {
    await served({ faults: () => ({ whole: true }) }, (scene, { requests }) => {
      assert.equal(scene.paged, false)
      assert.equal(requests, 1)
      assert.deepEqual(Buffer.from(scene.packed), readFileSync(file))
    })
  },
}

for (const [name, test] of Object.entries(tests))
  try {
    await test()
    console.log(`ok moving: ${name}`)
  } catch (error) {
    console.log(`FAIL moving: ${name}: ${error.stack}`)
    process.exitCode = 1
  }
process.exit()
