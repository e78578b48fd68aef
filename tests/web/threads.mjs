// node threads.mjs PACKAGE SCENE.fxs OTHER.fxs HASH: checks the npm package's use of threads in Node. HASH is the hash
// of the right picture of SCENE.fxs.
import assert from 'node:assert/strict'
import { copyFileSync, mkdtempSync, readdirSync, readFileSync, rmSync } from 'node:fs'
import { createRequire, syncBuiltinESMExports } from 'node:module'
import { tmpdir } from 'node:os'
import { join, resolve } from 'node:path'
import { pathToFileURL } from 'node:url'

const [folder, file, other, wanted] = process.argv.slice(2)
const workers = createRequire(import.meta.url)('node:worker_threads')
const size = { width: 320, height: 200 }
let copies = 0

const anew = (from = folder) => import(`${pathToFileURL(resolve(from, 'fixsplat.js'))}?${copies++}`)

function hash(pixels) {
  let h = 0xcbf29ce484222325n
  for (const byte of pixels) h = BigInt.asUintN(64, (h ^ BigInt(byte)) * 0x100000001b3n)
  return h.toString(16).padStart(16, '0')
}

const isRight = (scene) => assert.equal(hash(scene.render({}, size)), wanted)
const wait = (ms) => new Promise((done) => setTimeout(done, ms))

async function until(is, words) {
  for (let i = 0; i < 500; i++, await wait(10)) if (is()) return
  assert.fail(words)
}

async function withWorker(Worker, run) {
  const before = workers.Worker
  workers.Worker = Worker
  syncBuiltinESMExports()
  await run()
  workers.Worker = before
  syncBuiltinESMExports()
}

const cases = {
  async 'draws before its threads have started, and with them'() {
    const { load } = await anew()
    const scene = await load(file, { threads: 3 })
    isRight(scene)
    await until(() => scene.threads === 3, 'threads do not start')
    for (let i = 0; i < 50; i++) isRight(scene)
  },

  async 'scenes share a module, and are drawn together'() {
    const { load, render } = await anew()
    const scenes = []
    for (const name of [file, other, file]) scenes.push(await load(name, { threads: 2 }))
    assert.equal(new Set(scenes.map((scene) => scene.inside[0])).size, 1)
    await until(() => scenes[2].threads === 2, 'no thread')
    const one = await Promise.all([file, other].map((name) => load(name, { threads: 1 })))
    assert.equal(one[0].threads, 1)
    const both = (pair) => hash(render(pair.map((scene, i) => ({ scene, translation: [i, 0, 0] })), {}, size))
    assert.equal(both(scenes.slice(0, 2)), both(one))
    assert.throws(() => both([scenes[0], one[1]]), /`threads`/)
  },

  async 'as many as asked for, or an error'() {
    const { load } = await anew()
    for (const threads of [0, 65, 1.5, '2']) await assert.rejects(load(file, { threads }), /threads: expected 1 to 64/)
    assert.equal((await load(file, { threads: 4, simd: false })).threads, 1)
  },

  async 'ends, and begins again'() {
    const { load, end } = await anew()
    const kept = await load(other, { threads: 2 })
    const first = await load(file, { threads: 3 })
    const { c } = first.inside[0]
    await until(() => first.threads === 3, 'no threads')
    first.free()
    await end()
    await until(() => c.threads() === 1, 'threads go on')
    await until(() => kept.threads === 2, 'a scene that is kept loses its thread')
    const second = await load(file, { threads: 3 })
    assert.notEqual(second.inside[0].c, c)
    isRight(second)
  },

  async 'ends while a scene is loaded'() {
    const { load, end, render } = await anew()
    const late = new Blob([readFileSync(file)])
    const arrayBuffer = late.arrayBuffer.bind(late)
    late.arrayBuffer = async () => {
      await wait(200)
      await end()
      return arrayBuffer()
    }
    const scene = await load(late, { threads: 2 })
    await until(() => scene.threads === 2, 'no thread')
    render([{ scene }, { scene: await load(other, { threads: 2 }) }], {}, size)
  },

  async 'a worker that cannot be made'() {
    const refuse = class { constructor() { throw new Error('blocked') } }
    await withWorker(refuse, async () => {
      const scene = await (await anew()).load(file, { threads: 2 })
      await wait(50)
      isRight(scene)
      assert.equal(scene.threads, 1)
    })
  },

  async 'a script that is not there'() {
    const short = mkdtempSync(join(tmpdir(), 'fixsplat-'))
    for (const name of readdirSync(folder).filter((name) => /\.(js|json|wasm)$/.test(name) && name !== 'thread_node.js'))
      copyFileSync(join(folder, name), join(short, name))
    const { load } = await anew(short)
    const scene = await load(file, { threads: 2 })
    await wait(200)
    isRight(scene)
    assert.equal(scene.threads, 1)
    rmSync(short, { recursive: true })
    isRight(scene)
  },

  async 'a thread that traps'() {
    const small = class extends workers.Worker {
      constructor(url, options) {
        super(url, { ...options, workerData: { ...options.workerData, stack: 16 } })
      }
    }
    const camera = { eye: [1, -2, -13], look: [0, 0, 0] }
    const right = hash((await (await anew()).load(file, { threads: 1 })).render(camera, size))
    const isSo = (scene) => assert.equal(hash(scene.render(camera, size)), right)
    await withWorker(small, async () => {
      const scene = await (await anew()).load(file, { threads: 2 })
      await until(() => scene.threads === 2, 'no thread')
      const { memory } = scene.inside[0].c
      let trapped = 0
      let room
      await until(() => {
        try {
          isSo(scene)
        } catch (error) {
          assert.ok(error instanceof WebAssembly.RuntimeError, error)
          trapped++
          room = memory.buffer.byteLength
        }
        return scene.threads === 1
      }, 'does not trap')
      assert.equal(trapped, 1)
      for (let i = 0; i < 10; i++) isSo(scene)
      assert.equal(memory.buffer.byteLength, room, 'the memory of the frame that trapped is not used again')
    })
  },

  async 'less memory than 4 GB, or none to share'() {
    const { Memory } = WebAssembly
    for (const most of [20000, 0]) {
      WebAssembly.Memory = function (limits) {
        if (limits.maximum > most) throw new RangeError('no room')
        return new Memory(limits)
      }
      const scene = await (await anew()).load(file, { threads: 2 })
      isRight(scene)
      if (most) await until(() => scene.threads === 2, 'no thread')
      else assert.equal(scene.inside[0].c.threads, undefined)
    }
    WebAssembly.Memory = Memory
  },

  async 'no SharedArrayBuffer'() {
    const { SharedArrayBuffer } = globalThis
    delete globalThis.SharedArrayBuffer
    const scene = await (await anew()).load(file, { threads: 2 })
    globalThis.SharedArrayBuffer = SharedArrayBuffer
    assert.equal(scene.threads, 1)
    isRight(scene)
  },
}

for (const [name, run] of Object.entries(cases)) {
  console.log(name)
  await run()
}
console.log('all')
