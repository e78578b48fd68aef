// node gpu_page.mjs PACKAGE SCENES MODULES PICTURES COMMAND: checks the viewer's page when it draws with WebGPU.
import assert from 'node:assert/strict'
import { changed, engineOf, hash, inside, moved, native, open, page, pause, run, without } from './chromium.mjs'

const SCENE = '?scene=/scenes/few.fxs'
const exact = async (backend) => {
  assert.equal(await inside('return v.backend'), backend)
  assert.equal(await hash(), native('few.fxs', await viewOf(), '640x360'))
}
const PARTS = '?scene=/scenes/parts.fxs%3Franges&budget=6000'
const exactParts = async () => {
  await moved()
  assert.equal(await inside('return v.backend'), 'webgpu')
  assert.equal(await hash(), native('parts.fxs', await viewOf(), '320x180', '0e1116', '--budget', '6000'))
}
const viewOf = () => inside('return v.view')
const before = (more) => (text) => `${more}\n${text}`
const faults = {
  'no adapter': 'GPU.prototype.requestAdapter = async () => null',
  'no device': `GPUAdapter.prototype.requestDevice = async () => Promise.reject(new Error('limits'))`,
  'a shader that does not compile': `const { createShaderModule } = GPUDevice.prototype
    GPUDevice.prototype.createShaderModule = function ({ code }) {
      return createShaderModule.call(this, { code: code.replace('fn gather_chunks(', 'fn gather_chunks(what ') })
    }`,
}

const slowWorker = (number) => `if (globalThis.GPU) {
  GPU.prototype.requestAdapter = async () => ({ info: { vendor: 'a card' } })
  let workers = 0
  window.Worker = class extends Worker {
    number = workers++
    set onmessage(hear) {
      super.onmessage = (event) => {
        const { result } = event.data
        if (result?.milliseconds && this.number === ${number}) result.milliseconds += 1e6
        if (result?.milliseconds && this.number === 1) window.tried = true
        if (result?.milliseconds && this.number === 0 && window.tried) window.trialEnded = true
        hear(event)
      }
    }
  }
}`

const slowProcessor = `if (globalThis.GPU) {
  GPU.prototype.requestAdapter = async () => ({ info: { vendor: 'a card' } })
  window.Worker = class extends Worker {
    set onmessage(hear) {
      super.onmessage = (event) => {
        const { result } = event.data
        if (result?.pixels) result.milliseconds += 1e6
        hear(event)
      }
    }
  }
}`

await run({
  async 'asked for: the bytes of the command, and in the settings'() {
    await open(`${SCENE}&backend=webgpu`)
    await exact('webgpu')
    await inside(`$('set').click()`)
    assert.equal(await inside(`return v.shadowRoot.querySelector('[name=backend]').value`), 'webgpu')
    await inside(`$('set').click(); v.setAttribute('backend', 'wasm')`)
    await moved()
    await exact('wasm')
  },

  async 'a device that is lost in mid-frame: the same anew, then the next'() {
    const watch = `const { requestDevice } = GPUAdapter.prototype
      GPUAdapter.prototype.requestDevice = async function (how) {
        return (self.device = await requestDevice.call(this, how))
      }
      const { submit } = GPUQueue.prototype
      GPUQueue.prototype.submit = function (list) {
        submit.call(this, list)
        if (self.losing) self.device.destroy()
        self.losing = false
      }`
    const lose = async () => {
      await engineOf().evaluate(() => (self.losing = true))
      await inside(`const next = v.getAttribute('background') === '#0e1116' ? '#0e1117' : '#0e1116'
        const drawn = new Promise((done) => v.addEventListener('frame', done, { once: true }))
        v.setAttribute('background', next)
        await drawn`)
      await moved()
    }
    const later = (text) => text.replace('AGAIN_MS = 5000', 'AGAIN_MS = 500000')
    await changed('/viewer/picture.js', later, () => changed('/viewer/worker.js', before(watch), async () => {
      await open(`${SCENE}&backend=webgpu&background=%23102030`)
      await inside(`const now = performance.now.bind(performance); performance.now = () => now() + 600000`)
      await lose()
      await exact('webgpu')
      await lose()
      await inside(`v.setAttribute('background', '#0e1116')`)
      await moved()
      await exact('webgl2')
      assert.equal(await inside(`return $('error').hidden`), true)
    }))
  },

  ...Object.fromEntries(Object.entries(faults).map(([what, fault]) => [`${what}: WebGL 2 takes over`, () =>
    changed('/viewer/worker.js', before(fault), async () => {
      await open(`${SCENE}&backend=webgpu`)
      await exact('webgl2')
      assert.doesNotMatch(await inside(`return $('note').textContent`), /the processor/)
    })])),

  async 'an element of no size, and back'() {
    await open(`${SCENE}&backend=webgpu`)
    await inside(`v.style.cssText = 'display: block; width: 0; height: 0'`)
    await pause(500)
    await inside(`v.style.cssText = ''`)
    await moved()
    await exact('webgpu')
    assert.equal(await inside(`return $('error').hidden`), true)
  },

  async 'a streamed scene: asked for, after a move, and found by a trial in its own worker'() {
    await open(`${PARTS}&backend=webgpu`, 320, 180)
    await exactParts()
    await page.keyboard.press('ArrowLeft', { delay: 300 })
    await exactParts()
    await without(slowProcessor, async () => {
      await open(PARTS, 320, 180)
      const isOnCard = () => document.querySelector('fixsplat-viewer').backend === 'webgpu'
      await page.waitForFunction(isOnCard, { timeout: 300000 })
      await exactParts()
      assert.equal(page.workers().filter((worker) => worker.url().endsWith('/viewer/worker.js')).length, 1)
    })
  },

  async 'the fastest is found by a trial'() {
    for (const [slow, faster] of [[0, 'webgpu'], [1, 'wasm']])
      await without(slowWorker(slow), async () => {
        await open(SCENE)
        await page.waitForFunction(() => window.trialEnded, { timeout: 120000 })
        await moved()
        await page.waitForFunction(() => document.querySelector('fixsplat-viewer').shadowRoot
          .getElementById('stage').children.length === 1)
        await exact(faster)
      })
    await open(SCENE)
    await pause(1000)
    assert.equal(page.workers().filter((worker) => worker.url().endsWith('/viewer/worker.js')).length, 1)
  },
})
