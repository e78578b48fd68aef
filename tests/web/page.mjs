// node page.mjs PACKAGE SCENES MODULES PICTURES COMMAND: checks the viewer's page in Chromium. Its pictures must equal
// the pictures of the command-line program COMMAND.
import assert from 'node:assert/strict'
import { copyFileSync, existsSync, mkdirSync, rmSync, statSync, writeFileSync } from 'node:fs'
import { resolve } from 'node:path'
import * as chromium from './chromium.mjs'
import { POLICY } from './policy.mjs'
import { walking } from './walk.mjs'
import { base, go, hash, inside, moved, native, open, page, pause, picture, shown, still, viewOf } from './chromium.mjs'

const { changed, folder, pictures, policy, ranges, rendered, run, scenes, strange, without, wordsOf } = chromium
const numbersOf = async () => (await viewOf()).split(',').map(Number)
const enginesOf = () => page.workers().filter((worker) => worker.url().endsWith('/worker.js'))
const SCENE = '?scene=/scenes/scene.fxs'

const slowWorker = (number) => `{
  const own = HTMLCanvasElement.prototype.getContext
  HTMLCanvasElement.prototype.getContext = function (kind) { return own.call(this, kind) }
  WebGL2RenderingContext.prototype.getParameter = () => 'a card'
  let workers = 0
  window.Worker = class extends Worker {
    number = workers++
    set onmessage(hear) {
      super.onmessage = (event) => {
        const { result } = event.data
        if (result?.milliseconds && this.number === ${number}) result.milliseconds += 1e5
        if (result?.milliseconds && this.number === 1) window.tried = true
        if (result?.milliseconds && this.number === 0 && window.tried) window.trialEnded = true
        hear(event)
      }
    }
  }
}`

const tests = {
  async 'empty page'() {
    await go('', 1280, 720)
    await picture('empty')
    assert.equal(await inside('return v.state'), 'empty')
    assert.equal(await inside(`return getComputedStyle($('empty')).display`), 'grid')
  },

  async 'the pixels of the command, and again by its link'() {
    await open('?scene=/scenes/scene.ply&background=%23102030#view=0.3,-0.9,-4,0,0,0,0,-1,0,45')
    const [view, first] = [await viewOf(), await hash()]
    assert.equal(first, native('scene.ply', view, '640x360', '102030'))
    const link = await inside('return v.link')
    assert.match(link, /scene=http.*#view=0.3,-0.9,-4,/)
    await open(`${new URL(link).search}${new URL(link).hash}`)
    assert.equal(await hash(), first)
    assert.deepEqual(strange, [])
    await go('?scene=/scenes/scene.ply#view=0,0,0,0,0,0,0,-1,0,45')
    assert.match(await wordsOf(), /looks nowhere/)
    await moved()
    assert.equal(await hash(), native('scene.ply', await viewOf(), '640x360'))
    await open('?scene=/scenes/scene.ply&background=red')
    assert.equal(await hash(), native('scene.ply', await viewOf(), '640x360'))
  },

  async 'a drag, the wheel and keys move; r goes back'() {
    await open(SCENE)
    const start = await viewOf()
    const motions = [
      () => page.mouse.wheel({ deltaY: -300 }),
      () => page.keyboard.press('ArrowLeft', { delay: 60 }),
      () => page.keyboard.press('w', { delay: 60 }),
      () => page.keyboard.press('+'),
      ...['left', 'right'].map((button) => async () => {
        await page.mouse.move(320, 180)
        await page.mouse.down({ button })
        await page.mouse.move(380, 150, { steps: 4 })
        await page.mouse.up({ button })
      }),
      () => page.mouse.click(320, 180, { count: 2 }),
    ]
    for (const move of motions) {
      const before = await viewOf()
      await move()
      await moved()
      assert.notEqual(await viewOf(), before, String(move))
    }
    await page.keyboard.press('r')
    await moved()
    assert.equal(await viewOf(), start)
    assert.deepEqual((await shown()).size, [640, 360])
  },

  async 'touch: one finger turns, two move and zoom'() {
    await open(SCENE)
    const touch = await page.createCDPSession()
    const points = (...list) => list.map(([x, y], id) => ({ x, y, id }))
    const send = (type, ...list) => touch.send('Input.dispatchTouchEvent', { type, touchPoints: points(...list) })
    const start = await numbersOf()
    await send('touchStart', [300, 180])
    await send('touchMove', [360, 180])
    await send('touchEnd')
    await moved()
    const turned = await numbersOf()
    assert.notDeepEqual(turned, start)
    assert.deepEqual(turned.slice(3, 6), start.slice(3, 6))
    await send('touchStart', [300, 180], [340, 180])
    await send('touchMove', [260, 180], [400, 200])
    await send('touchEnd')
    await moved()
    const pinched = await numbersOf()
    const far = (n) => Math.hypot(n[0] - n[3], n[1] - n[4], n[2] - n[5])
    assert.ok(far(pinched) < 0.5 * far(turned))
    assert.notDeepEqual(pinched.slice(3, 6), turned.slice(3, 6))
  },

  async 'resize keeps the vertical field of view'() {
    await open(SCENE)
    const view = await viewOf()
    await page.setViewport({ width: 500, height: 420 })
    await moved()
    assert.equal(await viewOf(), view)
    assert.equal(await hash(), native('scene.fxs', view, '500x420'))
  },

  async 'views of a cameras.json'() {
    await open(`${SCENE}&cameras=/scenes/cameras.json`)
    const first = await viewOf()
    await page.keyboard.press('n')
    await moved()
    const second = await viewOf()
    assert.notEqual(second, first)
    await page.keyboard.press('p')
    await moved()
    assert.equal(await viewOf(), first)
    assert.equal(await hash(), native('scene.fxs', first, '640x360'))
  },

  async 'the element in a page of its own; its end ends its worker'() {
    await go('')
    await page.setContent(`<base href="${base}/"><script type="module" src="viewer/viewer.js"></script>
      <fixsplat-viewer style="width: 300px; height: 200px" src="scenes/scene.ply" keep="0"
        background="#000000"></fixsplat-viewer>`)
    await still()
    assert.equal(await hash(), native('scene.ply', await viewOf(), '300x200', '000000'))
    const at = `${base}/scenes/scene.fxs`
    for (let i = 0; i < 5; i++) assert.ok(await inside(`return v.open(args[0])`, at))
    const are = async (workers, count) => {
      for (let i = 0; i < 50 && workers().length !== count; i++) await pause(100)
      assert.equal(workers().length, count)
    }
    assert.deepEqual(await inside('return Promise.all([1, 2, 3].map(() => v.open(args[0])))', at), [false, false, true])
    await moved()
    assert.equal(await hash(), native('scene.ply', await viewOf(), '300x200', '000000'))
    await are(enginesOf, 1)
    await inside('v.remove()')
    await are(() => page.workers(), 0)
    await page.evaluate(async (src) => {
      for (let i = 0; i < 3; i++) {
        const own = Object.assign(document.createElement('fixsplat-viewer'), { style: 'width: 60px; height: 40px' })
        own.setAttribute('src', src)
        own.setAttribute('threads', 1)
        document.body.append(own)
        while (own.state !== 'still') await new Promise((done) => setTimeout(done, 20))
        own.remove()
      }
    }, at)
    await are(enginesOf, 2)
  },

  async 'several scenes at their places, moved, taken away and put back'() {
    const counts = { worker: 0, scene: 0 }
    const count = (request) => {
      if (request.url().endsWith('/worker.js')) counts.worker++
      if (request.url().endsWith('scene.ply')) counts.scene++
    }
    page.on('request', count)
    try {
      await go('')
      await page.setContent(`<base href="${base}/"><script type="module" src="viewer/viewer.js"></script>
        <div id="a"><fixsplat-viewer style="width: 300px; height: 200px" src="scenes/scene.ply" background="#000000">
        <fixsplat-scene src="scenes/levels.fxs" position="6 0 0" rotation="0 90 0" scale="0.5"></fixsplat-scene>
        </fixsplat-viewer></div><div id="b"></div>`)
      await page.waitForFunction(() => document.querySelector('fixsplat-viewer').scenes?.length === 2)
      await moved()
      const both = await viewOf()
      const n = both.split(',')
      const camera = ['--eye', n.slice(0, 3).join(), '--look', n.slice(3, 6).join(), '--up', n.slice(6, 9).join()]
      const quaternion = [Math.SQRT1_2, 0, Math.SQRT1_2, 0].join()
      const beside = [`${scenes}/levels.fxs`, '--place', `1:6,0,0,${quaternion},0.5`]
      const options = [...beside, ...camera, '--fov', n[9], '--size', '300x200', '--bg', '000000']
      const together = await hash()
      assert.equal(together, rendered('scene.ply', ...options))
      assert.notEqual(together, native('scene.ply', both, '300x200', '000000'))
      assert.deepEqual(await inside('return v.scenes.map(({ name, element }) => [name, element && element.localName])'),
        [['scene.ply', null], ['levels.fxs', 'fixsplat-scene']])
      const found = await inside(`return Promise.all([...Array(30).keys()].map((i) => v.pick(10 * i, 100)))`)
      const names = new Set(found.filter(Boolean).map(({ scene }) => scene.name))
      assert.deepEqual(names, new Set(['scene.ply', 'levels.fxs']))

      const before = { ...counts }
      await inside(`document.getElementById('b').append(v)`)
      await moved()
      await inside(`window.away = v; v.remove(); await new Promise((done) => setTimeout(done, 100));
        document.getElementById('a').append(window.away)`)
      await moved()
      assert.equal(await hash(), together)
      await inside(`v.removeAttribute('src')`)
      await moved()
      assert.deepEqual(await inside('return v.scenes.map(({ name }) => name)'), ['levels.fxs'])
      await inside(`window.child = v.firstElementChild; window.child.remove()`)
      await page.waitForSelector('fixsplat-viewer[state=empty]:not([open])')
      await inside(`v.append(window.child); v.setAttribute('src', 'scenes/scene.ply')`)
      await moved()
      await inside(`v.setAttribute('view', args[0])`, both)
      await moved()
      assert.equal(await hash(), together)
      assert.deepEqual(counts, before)

      await inside(`window.child.position = [0, 0, 0]`)
      await moved()
      assert.notEqual(await hash(), together)
      await inside(`window.child.position = 'here'`)
      assert.match(await wordsOf(), /position="here": expected 3 numbers/)
      await inside(`window.child.position = [6, 0, 0]; window.child.hidden = true`)
      await moved()
      assert.equal(await hash(), native('scene.ply', both, '300x200', '000000'))
      await inside(`window.child.src = 'scenes/none.ply'`)
      assert.match(await wordsOf(), /none\.ply: there is no such file/)
      await moved()
      assert.equal(await hash(), native('scene.ply', both, '300x200', '000000'))

      await inside(`window.child.src = 'scenes/levels.fxs'; window.child.hidden = false
        const other = document.createElement('fixsplat-viewer')
        other.setAttribute('src', 'scenes/none.ply')
        v.replaceWith(other)
        other.append(window.child)`)
      await still()
      assert.deepEqual(await inside('return v.scenes.map(({ name }) => name)'), ['levels.fxs'])
      await inside(`v.setAttribute('src', 'scenes/scene.ply?slow'); window.child.remove(); v.removeAttribute('src')`)
      await page.waitForSelector('fixsplat-viewer[state=empty]:not([open])')
      await pause(2000)
      assert.deepEqual(await inside('return [v.scenes.length, v.state]'), [0, 'empty'])
    } finally {
      page.off('request', count)
    }
  },

  async 'camera, settings, picks and events of the element; its own size; the wheel that scrolls the page'() {
    await go('', 800, 600)
    await page.setContent(`<base href="${base}/"><script type="module" src="viewer/viewer.js"></script>
      <style>body { margin: 0; height: 3000px } .small { width: 300px } .fixed { height: 100px; min-height: 0 }</style>
      <fixsplat-viewer src="scenes/scene.ply" wheel="page"></fixsplat-viewer>
      <fixsplat-viewer class="small"></fixsplat-viewer><fixsplat-viewer class="fixed"></fixsplat-viewer>`)
    await inside(`v.told = []; for (const name of ['load', 'progress', 'error', 'camera', 'pick', 'frame'])
      v.addEventListener(name, (event) => v.told.push([name, event.detail ?? event.message]))`)
    await still()
    const sizes = await page.evaluate(() => [...document.querySelectorAll('fixsplat-viewer')]
      .map((one) => [one.clientWidth, one.clientHeight]))
    assert.deepEqual(sizes, [[800, 450], [300, 169], [800, 100]])
    const told = (name) =>
      inside('return v.told.filter(([name]) => name === args[0]).map(([, detail]) => detail)', name)
    const [load] = await told('load')
    assert.deepEqual([load.source, load.name, load.count, load.low.length, load.element],
      [`${base}/scenes/scene.ply`, 'scene.ply', 20000, 3, null])
    assert.ok((await told('progress')).some(({ stage, done }) => stage === 'prepare' && done > 0))
    assert.equal((await told('frame')).at(-1).width, 800)

    await inside(`v.camera = { eye: [0, -1, -6], look: [0, 0, 0] }`)
    await moved()
    assert.deepEqual(await inside('return v.camera'),
      { eye: [0, -1, -6], look: [0, 0, 0], up: [0, -1, 0], fov: 50, flat: false, shift: [0, 0] })
    assert.equal(await hash(), native('scene.ply', '0,-1,-6,0,0,0,0,-1,0,50', '800x450'))
    const wrong = await inside(`try { v.camera = { eye: [0, 1] } } catch ({ message }) { return message }`)
    assert.equal(wrong, 'camera: eye: expected 3 numbers')
    assert.equal(await inside(`return v.flyTo({ eye: [3, -1, -6], fov: 40 }, { duration: 200 })`), true)
    assert.deepEqual(await inside('return [v.camera.eye, v.camera.fov]'), [[3, -1, -6], 40])
    const flight = inside(`return v.flyTo({ eye: [9, -1, -6] }, { duration: 5000 })`)
    await pause(200)
    await page.mouse.move(400, 200)
    await page.mouse.down()
    await page.mouse.move(420, 220, { steps: 3 })
    await page.mouse.up()
    assert.equal(await flight, false)
    const cameras = await told('camera')
    assert.ok(cameras.some(({ byHand }) => byHand) && cameras.some(({ byHand }) => !byHand))

    const settings = await inside(`v.settings = { background: '#405060', fov: 30, sharpness: 0.5 }; return v.settings`)
    assert.deepEqual([settings.background, settings.fov, settings.sharpness], ['#405060', 30, 0.5])
    const unknown = await inside(`try { v.settings = { colour: 1 } } catch ({ message }) { return message }`)
    assert.match(unknown, /^colour: expected/)
    await moved()
    assert.equal((await shown()).size.join(), '400,225')
    await inside(`v.settings = { sharpness: 1, background: null }; v.camera = { eye: [0, -1, -6], look: [0, 0, 0] }`)
    await moved()

    const y = await inside(`v.told = []
      for (let y = 100; y < 225; y += 5) if (await v.pick(400, y)) return y`)
    await page.mouse.click(400, y)
    await page.waitForFunction(() => document.querySelector('fixsplat-viewer').told.some(([name]) => name === 'pick'))
    await page.mouse.click(3, 3)
    await pause(500)
    const [hit, miss] = await told('pick')
    const same = await inside('return v.pick(400, args[0])', y)
    assert.deepEqual([hit.x, hit.y, hit.found], [400, y, same])
    assert.ok(same.scene.name === 'scene.ply' && same.position.length === 3 && same.depth > 0)
    assert.equal(miss.found, null)

    const wheel = async () => {
      const [before, top] = [await viewOf(), await page.evaluate(() => scrollY)]
      await page.mouse.move(400, 200)
      await page.mouse.wheel({ deltaY: 50 })
      await pause(400)
      return [(await viewOf()) !== before, (await page.evaluate(() => scrollY)) !== top]
    }
    assert.deepEqual(await wheel(), [true, false])
    await inside('document.activeElement.blur()')
    assert.deepEqual(await wheel(), [false, true])
    assert.match(await inside(`return $('note').textContent`), /hold Ctrl/)
    await page.keyboard.down('Control')
    assert.deepEqual(await wheel(), [true, false])
    await page.keyboard.up('Control')
    await inside(`scrollTo(0, 0); v.setAttribute('src', 'scenes/none.ply')`)
    await wordsOf()
    assert.match((await told('error'))[0], /none\.ply: there is no such file/)
  },

  async 'turns about what an .fxs says is up, about no axis, or about what is given'() {
    const [ups, given] = [[0.5, -0.8660254, 0], [0.6, -0.64, 0.48]]
    const dot = (a, b) => a.reduce((sum, x, i) => sum + x * b[i], 0)
    const near = (a, b) => assert.ok(a.every((x, i) => Math.abs(x - b[i]) < 2e-4), `${a} is not ${b}`)
    const seen = async (up) => {
      const { eye, look, up: top } = await inside('return v.camera')
      const [b, a] = [top, eye.map((x, i) => x - look[i])]
      const right = [b[1] * a[2] - b[2] * a[1], b[2] * a[0] - b[0] * a[2], b[0] * a[1] - b[1] * a[0]]
      return [dot(right, up) / Math.hypot(...right), dot(a, up), eye]
    }
    const dragged = async (dx, dy) => {
      await page.mouse.move(300, 180)
      await page.mouse.down()
      await page.mouse.move(300 + dx, 180 + dy, { steps: 4 })
      await page.mouse.up()
    }
    const turns = async (wanted) => {
      const up = await inside('return v.settings.up')
      near(up, wanted)
      const [roll, height, eye] = await seen(up)
      await dragged(150, 0)
      const [rolled, same, elsewhere] = await seen(up)
      near([roll, rolled, same], [0, 0, height])
      assert.ok(Math.hypot(...eye.map((x, i) => x - elsewhere[i])) > 1)
      await dragged(-90, 60)
      near([(await seen(up))[0]], [0])
    }
    await go('?scene=/scenes/leant.fxs')
    await still()
    near((await seen(ups))[2], [3, -2, -5])
    await turns(ups)
    // Checks the up direction after a camera is read from a settings file. A camera without roll keeps the viewer's up
    // direction; a camera with roll defines it.
    const readCamera = (camera) =>
      inside('await v.readSettings({ fixsplat: 1, camera: args[0] })', { fov: 40, ...camera })
    const { eye, look, up } = await inside('return v.camera')
    await readCamera({ eye, look, up })
    await turns(ups)
    await readCamera({ eye: [0, 0, -9], look: [0, 0, 0], up: [0, -1, 0] })
    near(await inside('return v.settings.up'), [0, -1, 0])
    await inside('v.settings = { up: args[0] }', given.map((x) => 3 * x))
    near(await inside('return v.settings.up.map((x) => x / 3)'), given)
    await dragged(150, 0)
    near([(await seen(given))[0]], [0])
    await go('?scene=/scenes/leant.fxs&cameras=/scenes/cameras.json')
    await still()
    near(await inside('return v.settings.up'), ups)
  },

  async 'errors in words; the page goes on'() {
    const wrong = {
      'none.ply': /no such file/,
      'text.ply': /text\.ply: this is no scene\. Scenes are \.fxs, /,
      'short.ply': /short\.ply: the file is cut off: 3 KB of 5\.0 MB/,
      'huge.ply': /huge\.ply: the file is damaged/,
      'scene.ply?cut': /broke off/,
      'http://127.0.0.1:1/a.ply': /cannot be reached/,
      '100%.ply': /100%\.ply: there is no such file/,
    }
    await open(SCENE)
    const before = await hash()
    for (const [address, words] of Object.entries(wrong)) {
      await inside(
        `$('error').hidden = true; v.setAttribute('src', args[0])`,
        new URL(address, `${base}/scenes/`).href
      )
      assert.match(await wordsOf(), words)
    }
    await picture('error')
    await page.keyboard.press('ArrowLeft', { delay: 60 })
    await moved()
    assert.notEqual(await hash(), before)
    await go('?scene=/scenes/scene.ply&cameras=/scenes/text.ply')
    assert.match(await wordsOf(), /not JSON/)
    await go('?scene=/scenes/none.ply')
    assert.match(await wordsOf(), /no such file/)
    assert.equal(await inside('return v.state'), 'empty')
    for (const address of ['?scene=http://[', '?poster=http://[&scene=http://[', `${SCENE}&cameras=http://[`]) {
      await go(address)
      assert.match(await wordsOf(), /http:\/\/\[: this is no address/)
    }
    await without(`Worker = class { constructor() { throw new Error('of another server') } }`, async () => {
      await go(SCENE)
      assert.match(await wordsOf(), /of another server/)
    })
  },

  async 'a dropped file, and its picture as a .png'() {
    await go('')
    await inside(`const bytes = await (await fetch('/scenes/scene.ply')).arrayBuffer(); const data = new DataTransfer();
      data.items.add(new File([bytes], 'dropped.ply')); v.dispatchEvent(new DragEvent('drop', { dataTransfer: data }))`)
    await still()
    assert.equal(await inside(`return $('name').textContent`), 'dropped.ply')
    await inside(
      `HTMLAnchorElement.prototype.click = async function () { 
          const bytes = new Uint8Array(await (await fetch(this.href)).arrayBuffer());
          v.saved = [this.download, bytes.slice(1, 4).join()] }`
    )
    await page.keyboard.press('i')
    await page.waitForFunction(() => document.querySelector('fixsplat-viewer').saved)
    assert.deepEqual(await inside('return v.saved'), ['dropped.ply.png', '80,78,71'])
    await page.keyboard.press('l')
    assert.match(await inside(`return $('note').textContent`), /file of yours/)
  },

  async 'several files, a folder, and what is among files'() {
    await go('')
    await inside(`const data = new DataTransfer()
      for (const name of ['scene.ply', 'levels.fxs', 'cameras.json'])
        data.items.add(new File([await (await fetch('/scenes/' + name)).arrayBuffer()], name))
      v.dispatchEvent(new DragEvent('drop', { dataTransfer: data }))`)
    await page.waitForFunction(() => document.querySelector('fixsplat-viewer').scenes.length === 2)
    await moved()
    assert.equal(await inside(`return $('name').textContent + ' | ' + $('count').textContent`),
      'levels.fxs and 1 more | 40,000 splats')
    assert.equal(await inside(`return $('after').hidden`), false)
    assert.equal(await hash(), rendered('levels.fxs', `${scenes}/scene.ply`, '--cameras', `${scenes}/cameras.json`,
      '--size', '640x360', '--bg', '0e1116'))

    mkdirSync(`${scenes}/folder/inside`, { recursive: true })
    copyFileSync(`${scenes}/scene.ply`, `${scenes}/folder/inside/one.ply`)
    writeFileSync(`${scenes}/folder/note.txt`, 'no scene')
    const session = await page.createCDPSession()
    const drop = async (file) => {
      const data = { items: [], files: [`${scenes}/${file}`], dragOperationsMask: 1 }
      for (const type of ['dragEnter', 'dragOver', 'drop'])
        await session.send('Input.dispatchDragEvent', { type, x: 300, y: 100, data })
    }
    await drop('folder')
    const isThere = () => document.querySelector('fixsplat-viewer').scenes[0]?.name === 'folder/inside/one.ply'
    await page.waitForFunction(isThere)
    await moved()
    assert.equal(await inside('return v.scenes.length'), 1)
    rmSync(`${scenes}/folder/inside`, { recursive: true })
    writeFileSync(`${scenes}/folder/more.txt`, 'none')
    await drop('folder')
    assert.match(await wordsOf(), /None of these files is a scene/)
    assert.equal(await inside('return v.scenes.length'), 1)

    const { scenesIn } = await import(resolve(folder, 'viewer/drop.js'))
    const found = (...names) => {
      const { scenes, views } = scenesIn(names.map((name) => ({ name })))
      return [scenes.map((one) => (Array.isArray(one) ? one.map(({ name }) => name).join('+') : one.name)), views?.name]
    }
    assert.deepEqual(found('b.ply', 'readme.txt', 'a.SPZ', 'cameras.json'), [['a.SPZ', 'b.ply'], 'cameras.json'])
    assert.deepEqual(found('x/tiles/a.glb', 'x/tileset.json', 'y/meta.json', 'y/sh.webp', 'z.ply'),
      [['x/tileset.json+x/tiles/a.glb', 'y/meta.json+y/sh.webp', 'z.ply'], undefined])
    assert.deepEqual(found('unknown'), [['unknown'], undefined])
    assert.deepEqual(found('one.txt', 'two.txt'), [[], undefined])
  },

  async 'a preview is shown where it is worth it'() {
    const begin = 'function preview(key, part, share) {'
    const tell = (text) => text.replace(begin, '$& (self.offered ??= []).push(part.count)')
    await changed('/viewer/worker.js', tell, () =>
      without(
        () => addEventListener('frame', ({ target }) => (window.counts ??= []).push(target.scenes[0].count), true),
        async () => {
          await go('?scene=/scenes/large.ply%3Ftrickle&threads=1')
          await still()
          const offered = await enginesOf()[0].evaluate(() => self.offered)
          const counts = await page.evaluate(() => window.counts)
          assert.ok(offered[0] < 2000, `${offered}`)
          assert.ok(counts.every((count) => count > 10000) && counts.at(-1) === 60000, `${counts}`)
        }
      ))
  },

  async 'the size in motion: as large as the machine can draw, and steady'() {
    const [{ Sizes }, { Pace }] = await Promise.all(
      ['viewer/pace.js', 'fixsplat.js'].map((name) => import(resolve(folder, name))))
    let seed = 1
    const random = () => (seed = (seed * 16807) % 2147483647) / 2147483647
    const clock = await Pace.open({ threads: 1 })
    for (const [fixed, all, noise, most] of [
      [0, 30, 0.1, 34],
      [0, 130, 0.1, 34],
      [10, 110, 0.1, 34],
      [70, 85, 0.1, 98],
      [300, 50, 0.1, 395],
      [10, 1000, 0.2, 94],
      [20, 100, 0.4, 32],
    ]) {
      const sizes = new Sizes(clock)
      const timeAt = (scale) => fixed + all * scale ** 2
      const take = (moves, scale) => sizes.take(moves, timeAt(scale) * (1 + noise * (2 * random() - 1)))
      let scale = take(false, 1)
      for (let motion = 0; motion < 2; motion++) {
        const scales = []
        for (let i = 0; i < 500; i++) scales.push((scale = take(true, scale)))
        const later = scales.slice(60)
        const [least, largest] = [Math.min(...later), Math.max(...later)]
        const words = `${fixed} + ${all} ms: ${least} to ${largest}, ${timeAt(largest)} ms`
        assert.ok(timeAt(largest) < 1.03 * most && (scale === 1 || timeAt(scale) > 0.75 * most), words)
        assert.ok(largest < 1.15 * least, words)
        scale = take(false, 1)
      }
    }
    clock.free()
  },

  async 'every control has a name; panels by key; noui'() {
    await open(SCENE)
    assert.deepEqual(
      await inside(`return [...v.shadowRoot.querySelectorAll('button, input, select, section, #stage')].filter((e) =>
      !(e.ariaLabel || e.textContent.trim() || e.labels?.[0]?.textContent.trim())).map((e) => e.outerHTML)`),
      []
    )
    const order = []
    for (let i = 0; i < 10; i++) {
      await page.keyboard.press('Tab')
      order.push(await inside('return v.shadowRoot.activeElement.id'))
    }
    assert.deepEqual(order, ['full', 'add', 'orbit', 'fly', 'walk', 'home', 'share', 'photo', 'set', 'keys'])
    await page.keyboard.press('h')
    assert.equal(await inside(`return $('help').hidden`), false)
    await page.keyboard.press('Escape')
    assert.equal(await inside(`return $('help').hidden`), true)
    await inside(`$('set').click(); v.shadowRoot.querySelector('[name=fov]').focus()`)
    await page.keyboard.press('Escape')
    assert.equal(await inside(`return $('options').hidden`), true)
    await open(`${SCENE}&noui`)
    assert.deepEqual(
      await inside(
        `return [...v.shadowRoot.querySelectorAll('.ui')].filter((e) => getComputedStyle(e).display !== 'none').length`
      ),
      0
    )
  },

  async 'the corner: the name of the scene, or its label, to be read on any picture'() {
    const named = () => inside(`return $('name').textContent`)
    await page.emulateMediaFeatures([{ name: 'prefers-color-scheme', value: 'light' }])
    await open('?scene=/scenes/scene.ply&label=A <knot>&background=%23000000')
    assert.equal(await named(), 'A <knot>')
    const contrast = await inside(`const of = (text) => text.match(/[\\d.]+/g).map(Number)
      const [plate, ink] = ['backgroundColor', 'color'].map((one) => of(getComputedStyle($('name').parentNode)[one]))
      const light = (rgb) => [0.2126, 0.7152, 0.0722].reduce((sum, share, i) => sum + share * (rgb[i] / 255) ** 2.2, 0)
      return (light(plate.map((x) => x * (plate[3] ?? 1))) + 0.05) / (light(ink) + 0.05)`)
    assert.ok(contrast > 7, contrast)
    await page.emulateMediaFeatures([{ name: 'prefers-color-scheme', value: 'dark' }])
    await inside(`v.removeAttribute('label')`)
    assert.equal(await named(), 'scene.ply')
    const linked = await inside(`v.setAttribute('label', 'Another'); return new URL(v.link).searchParams.get('label')`)
    assert.equal(linked, 'Another')
    await inside(`const data = new DataTransfer()
      data.items.add(new File([await (await fetch('/scenes/scene.fxs')).arrayBuffer()], 'dropped.fxs'))
      v.dispatchEvent(new DragEvent('drop', { dataTransfer: data }))`)
    for (let i = 0; (await named()) !== 'dropped.fxs'; i++) assert.ok(i < 100, await pause(100))
  },

  async 'in the width of a phone nothing lies outside'() {
    await open(`${SCENE}&cameras=/scenes/cameras.json`, 360, 740)
    for (const panel of ['options', 'help'])
      assert.deepEqual(
        await inside(`$('${panel}').hidden = false;
        const out = [...v.shadowRoot.querySelectorAll('button, p, label, dl')].filter((e) => {
        const r = e.getBoundingClientRect();
        return r.width && (r.left < 0 || r.right > 360) }).map((e) => e.id || e.outerHTML);
        $('${panel}').hidden = true; return out`),
        []
      )
    await inside(`for (const [side, room] of args[0]) v.style.setProperty(side, room)`, [
      ['--above', '40px'],
      ['--below', '30px'],
    ])
    const places = await inside(`const box = (name) => v.shadowRoot.querySelector(name).getBoundingClientRect();
      return [box('.top').top, box('.bar').bottom]`)
    assert.deepEqual(places, [50, 740 - 36])
    await picture('phone')
    await page.keyboard.press('h')
    await picture('phone-keys')
  },

  async 'each back end that is asked for: in the same bytes'() {
    for (const backend of ['wasm', 'webgl2']) {
      await open(`${SCENE}&backend=${backend}`)
      assert.equal(await inside('return v.backend'), backend)
      assert.equal(await hash(), native('scene.fxs', await viewOf(), '640x360'))
      await inside(`$('set').click()`)
      assert.equal(await inside(`return v.shadowRoot.querySelector('[name=backend]').value`), backend)
    }
    await inside(`v.setAttribute('backend', 'wasm')`)
    await moved()
    assert.equal(await hash(), native('scene.fxs', await viewOf(), '640x360'))
  },

  async 'of back ends asked for in a row the last draws; the others are freed'() {
    const count = (text) => `${text}\nself.count = () => Object.keys(screens).length`
    await changed('/viewer/worker.js', count, async () => {
      await open(`${SCENE}&backend=wasm`)
      const asked = ['webgl2', 'wasm', 'webgl2', 'wasm']
      await inside(`for (const name of args[0]) v.setAttribute('backend', name)`, asked)
      await moved()
      await pause(300)
      assert.equal(await inside('return v.backend'), 'wasm')
      assert.equal(await hash(), native('scene.fxs', await viewOf(), '640x360'))
      assert.equal(await enginesOf()[0].evaluate(() => self.count()), 1)
      await inside(`v.setAttribute('backend', 'webgl2'); v.remove()`)
      await pause(300)
    })
  },

  async 'a budget: by the attribute, the slider and keys; what was drawn is shown'() {
    const LEVELS = '?scene=/scenes/levels.fxs'
    const exact = async (...options) => {
      await moved()
      const n = (await viewOf()).split(',')
      const camera = ['--eye', n.slice(0, 3).join(), '--look', n.slice(3, 6).join(), '--up', n.slice(6, 9).join()]
      const args = [...camera, '--fov', n[9], '--size', '640x360', '--bg', '0e1116']
      assert.equal(await hash(), rendered('levels.fxs', ...args, ...options))
      return inside(`return $('draws').textContent`)
    }
    await open(`${LEVELS}&budget=5000&backend=webgl2`)
    assert.match(await exact('--budget', '5000'), /, [1-4],\d\d\d splats$/)
    assert.match(await inside('return v.link'), /budget=5000/)
    await inside(`v.setAttribute('budget', 3000); v.setAttribute('backend', 'wasm')`)
    assert.match(await exact('--budget', '3000'), /, [12],\d\d\d splats$/)
    await inside(`v.setAttribute('detail', 8); v.removeAttribute('budget')`)
    await exact('--detail', '8')
    await inside(`v.removeAttribute('detail'); $('set').click()`)
    assert.match(await exact(), /, 20,224 splats$/)
    assert.equal(await inside(`return $('levels').hidden || $('budget').textContent`), 'without limit')
    await inside(`const slider = v.shadowRoot.querySelector('[name=budget]'); slider.value = 0;
      slider.dispatchEvent(new InputEvent('input', { bubbles: true }))`)
    assert.equal(await inside(`return v.getAttribute('budget') + $('budget').textContent`), '50000at most 50,000')
    await exact()
    await inside(`$('set').click(); v.setAttribute('budget', '200000')`)
    for (const key of ['v', 'b']) {
      await page.keyboard.press(key)
      assert.equal(await inside(`return v.getAttribute('budget')`), null)
      assert.equal(await inside(`return $('note').textContent`), 'without limit')
      await inside(`v.setAttribute('budget', '40000')`)
    }
    await changed('/viewer/viewer.js', (text) => text.replace('const BUDGETS = [', '$&1e3, 5e3, 1e4, '), async () => {
      await open(LEVELS)
      const seen = []
      for (const key of 'bbbbvvvvv') {
        await page.keyboard.press(key)
        seen.push(await inside(`return v.getAttribute('budget')`))
      }
      assert.deepEqual(seen, ['10000', '5000', '1000', '1000', '5000', '10000', null, null, null])
    })
    await open(SCENE)
    await page.keyboard.press('b')
    assert.match(await inside(`return $('note').textContent`), /no levels/)
    assert.equal(await inside(`return $('levels').hidden && v.getAttribute('budget')`), null)
  },

  async 'a scene in parts: seen at once, whole at rest, and kept for the next visit'() {
    const PARTS = '?scene=/scenes/parts.fxs%3Franges&budget=15000'
    const size = statSync(`${scenes}/parts.fxs`).size
    const exact = async () => {
      await moved()
      const n = (await viewOf()).split(',')
      const camera = ['--eye', n.slice(0, 3).join(), '--look', n.slice(3, 6).join(), '--up', n.slice(6, 9).join()]
      const args = [...camera, '--fov', n[9], '--size', '640x360', '--bg', '0e1116', '--budget', '15000']
      assert.equal(await hash(), rendered('parts.fxs', ...args))
    }
    const kept = () => page.evaluate(async () => (await (await caches.open('fixsplat')).keys()).length)
    ranges.wait = 0.2
    await without(
      () => addEventListener('frame', ({ detail }) => (window.seen ??= []).push(detail.missing), true),
      async () => {
        await go(PARTS)
        await still()
        const seen = await page.evaluate(() => window.seen)
        assert.ok(seen.length > 2 && seen[0] > 0 && seen.at(-1) === 0, `${seen}`)
      }
    )
    await exact()
    const { sent } = ranges
    assert.ok(sent < 0.9 * size, `${sent} of ${size}`)
    ranges.wait = 0
    await page.keyboard.press('ArrowLeft', { delay: 300 })
    await exact()
    await inside(`v.setAttribute('backend', 'webgl2')`)
    await exact()
    await page.keyboard.press('r')
    await exact()

    ranges.sent = 0
    const count = await kept()
    assert.ok(count > 3)
    await open(PARTS)
    await exact()
    assert.equal(ranges.sent, 192)
    await page.evaluate(async () => {
      const cache = await caches.open('fixsplat')
      for (const key of await cache.keys()) {
        const bytes = new Uint8Array(await (await cache.match(key)).arrayBuffer())
        await cache.put(key, new Response(bytes.fill(9, bytes.length >> 1)))
      }
    })
    await open(PARTS)
    await exact()
    assert.ok(ranges.sent > 10000)
    ranges.tag = '"two"'
    ranges.sent = 0
    await open(PARTS)
    await exact()
    assert.ok(ranges.sent > 10000 && (await kept()) <= count + 2)
  },

  async 'annotations of a scene in parts: which are hidden is known by what is there'() {
    ranges.tag = '"near"'
    await open('?scene=/scenes/parts.fxs%3Franges&detail=3#view=0,-2.6,-2,0,-2.6,2,0,-1,0,40')
    await moved()
    ranges.sent = 0
    await inside(`const { eye } = v.camera, found = []
      for (let x = 40; x < 640; x += 60) found.push(await v.pick(x, 180))
      const beyond = ({ position }) => position.map((x, i) => eye[i] + 1.5 * (x - eye[i]))
      v.annotations = found.filter(Boolean).map((one) => ({ position: beyond(one) }))`)
    await page.waitForFunction(`document.querySelector('fixsplat-viewer').shadowRoot.querySelector('.marker.behind')`)
    await pause(300)
    assert.equal(ranges.sent, 0)
  },

  async 'a scene in parts that changes on its server: words, and the page goes on'() {
    ranges.tag = '"three"'
    await open('?scene=/scenes/parts.fxs%3Franges&budget=3000')
    ranges.tag = '"four"'
    await inside(`v.setAttribute('budget', 14000)`)
    assert.match(await wordsOf(), /has changed on its server/)
    await moved()
    await page.keyboard.press('ArrowLeft', { delay: 60 })
    await moved()
    await open('?scene=/scenes/parts.fxs&budget=3000')
    assert.equal(await inside(`return $('error').hidden`), true)
  },

  async 'the faster of two is found by a trial'() {
    for (const [slow, faster] of [
      [0, 'webgl2'],
      [1, 'wasm'],
    ])
      await without(slowWorker(slow), async () => {
        await open(SCENE)
        await page.waitForFunction(() => window.trialEnded, { timeout: 60000 })
        await moved()
        assert.equal(await inside('return v.backend'), faster)
        assert.equal(await hash(), native('scene.fxs', await viewOf(), '640x360'))
        assert.equal(await inside(`return $('stage').children.length`), 1)
      })
    await open(SCENE)
    await pause(1000)
    assert.equal(enginesOf().length, 1)
  },

  async 'a lost context: the same anew, and the processor where it is lost again'() {
    const watch = (text) => `const own = OffscreenCanvas.prototype.getContext
      OffscreenCanvas.prototype.getContext = function (...a) { return (self.seen = own.apply(this, a)) }\n${text}`
    const lose = async () => {
      const [worker] = enginesOf()
      await worker.evaluate(() => self.seen.getExtension('WEBGL_lose_context').loseContext())
      await pause(500)
      await moved()
      assert.equal(await hash(), native('scene.fxs', await viewOf(), '640x360'))
    }
    await changed('/viewer/worker.js', watch, async () => {
      await open(`${SCENE}&backend=webgl2`)
      await inside(`const now = performance.now.bind(performance); let more = 0; v.later = () => (more += 6000);
        performance.now = () => now() + more; v.later()`)
      await lose()
      assert.equal(await inside('return v.backend'), 'webgl2')
      await lose()
      assert.equal(await inside('return v.backend'), 'wasm')
      assert.equal(await inside(`return $('error').hidden`), true)
    })
  },

  async 'lost in the middle of a picture, and restored: the same anew, without a word'() {
    const inMiddle = (text) => `for (const name of ['drawArrays', 'texSubImage2D']) {
        const own = WebGL2RenderingContext.prototype[name]
        WebGL2RenderingContext.prototype[name] = function (...args) {
          own.apply(this, args)
          if (!self.armed || --self.armed) return
          const lose = this.getExtension('WEBGL_lose_context')
          lose.loseContext()
          setTimeout(() => lose.restoreContext())
          self.lost = (self.lost ?? 0) + 1
        }
      }
      const ask = OffscreenCanvas.prototype.getContext
      OffscreenCanvas.prototype.getContext = function (...args) {
        this.addEventListener('webglcontextlost', (event) => event.preventDefault())
        return ask.apply(this, args)
      }\n${text}`
    await changed('/viewer/worker.js', inMiddle, async () => {
      await open(`${SCENE}&backend=webgl2`)
      await inside(`const now = performance.now.bind(performance); let more = 0; performance.now = () => now() + more
        v.later = () => (more += 6000)`)
      const [worker] = enginesOf()
      await page.mouse.move(320, 180)
      await page.mouse.down()
      for (let round = 1; round <= 3; round++) {
        await inside('v.later()')
        await worker.evaluate((round) => (self.armed = round), round)
        for (let i = 0; i < 8; i++) {
          await page.mouse.move(320 + 20 * i, 180 + round)
          await pause(30)
        }
        await page.waitForFunction(() => document.querySelector('fixsplat-viewer').backend === 'webgl2')
      }
      await page.mouse.up()
      await moved()
      assert.ok((await worker.evaluate(() => self.lost)) >= 2)
      assert.equal(await inside('return v.backend'), 'webgl2')
      assert.equal(await hash(), native('scene.fxs', await viewOf(), '640x360'))
      assert.equal(await inside(`return $('error').hidden`), true)
    })
  },

  async 'under the policy of the documentation'() {
    const refused = []
    const listen = (message) => /Content Security Policy/i.test(message.text()) && refused.push(message.text())
    page.on('console', listen)
    policy.text = POLICY
    try {
      await open(`${SCENE}&poster=/scenes/poster.png&cameras=/scenes/cameras.json`)
      assert.equal(await hash(), native('scene.ply', await viewOf(), '640x360'))
      await inside(`$('set').click(); v.append(Object.assign(document.createElement('fixsplat-scene'),
        { src: '/scenes/levels.fxs', position: [1, 0, 0] })); v.setAttribute('backend', 'webgl2')`)
      await page.waitForFunction(() => document.querySelector('fixsplat-viewer').scenes.length === 2)
      await page.keyboard.press('h')
      await moved()
      await inside(`const bytes = await (await fetch('/scenes/scene.ply')).arrayBuffer()
        const data = new DataTransfer()
        data.items.add(new File([bytes], 'dropped.ply'))
        v.dispatchEvent(new DragEvent('drop', { dataTransfer: data }))`)
      await page.waitForFunction(() => document.querySelector('fixsplat-viewer').scenes[0].name === 'dropped.ply')
      await moved()
      assert.deepEqual(refused, [])
      assert.equal(await inside('return getComputedStyle(v).opacity'), '1')
      policy.text = POLICY.replace(" 'wasm-unsafe-eval'", '')
      await go(SCENE)
      assert.match(await wordsOf(), /needs 'wasm-unsafe-eval' in script-src/)
    } finally {
      policy.text = ''
      page.off('console', listen)
    }
  },

  async 'no WebGL, no SIMD, no canvas for workers, no WebAssembly'() {
    const exact = async () => {
      await open(`${SCENE}&backend=webgl2`)
      assert.equal(await inside('return v.backend'), 'wasm')
      assert.match(await inside(`return $('note').textContent`), /the processor does/)
      assert.equal(await hash(), native('scene.fxs', await viewOf(), '640x360'))
    }
    const before = (more) => (text) => `${more}\n${text}`
    const none = 'OffscreenCanvas.prototype.getContext = new Proxy(OffscreenCanvas.prototype.getContext, ' +
      '{ apply: (own, self, [kind]) => (kind === "webgl2" ? null : own.call(self, kind)) })'
    await changed('/viewer/worker.js', before(none), exact)
    await changed('/fixsplat.js', before('WebAssembly.validate = () => false'), exact)
    await without(() => delete HTMLCanvasElement.prototype.transferControlToOffscreen, exact)
    await without(
      () => delete window.WebAssembly,
      async () => {
        await go(SCENE)
        assert.match(await wordsOf(), /WebAssembly/)
      }
    )
  },

  async 'a picture larger than the page, in strips: the bytes of the command'() {
    const small = (text) => text.replace('STRIP = 1 << 22', 'STRIP = 1 << 13')
    await changed('/viewer/worker.js', small, () => open(SCENE, 170, 160))
    await inside(`HTMLAnchorElement.prototype.click = function () { v.saved = this.href }
      const select = v.shadowRoot.querySelector('[name=enlarge]')
      select.value = '4'
      select.dispatchEvent(new InputEvent('input', { bubbles: true }))
      v.shadowRoot.getElementById('stage').focus()`)
    await page.keyboard.press('i')
    await page.waitForFunction(() => document.querySelector('fixsplat-viewer').saved)
    const [size, seen] = await inside(`const seen = await createImageBitmap(await (await fetch(v.saved)).blob())
      const { width, height } = seen, context = new OffscreenCanvas(width, height).getContext('2d')
      context.drawImage(seen, 0, 0)
      let h = 0xcbf29ce484222325n
      for (const b of context.getImageData(0, 0, width, height).data)
        h = BigInt.asUintN(64, (h ^ BigInt(b)) * 0x100000001b3n)
      return [[width, height].join('x'), h.toString(16).padStart(16, '0')]`)
    assert.deepEqual([size, seen], ['680x640', native('scene.fxs', await viewOf(), '680x640')])
    const tooLarge = await inside('return v.picture({ scale: 200 }).catch((error) => error.message)')
    assert.match(tooLarge, /expected 1 to 16384/)
  },

  async 'tone curve, exposure and vignette: on the screen, never in the pixels of the canvas'() {
    const grey = '&background=%23808080&noui#view=0,0,-9,0,0,0,0,-1,0,40'
    const seen = async (places) => inside(`const bytes = Uint8Array.from(atob(args[0]), (c) => c.charCodeAt())
      const image = await createImageBitmap(new Blob([bytes])), context = new OffscreenCanvas(640, 360).getContext('2d')
      context.drawImage(image, 0, 0)
      return args[1].map(([x, y]) => context.getImageData(x, y, 1, 1).data[0])`,
    await page.screenshot({ encoding: 'base64' }), places)
    // 255 s(2^exposure l(128 / 255)), with l and s of sRGB; for filmic and aces, of the curve's value
    const curves = { 'exposure=1': 176, 'exposure=-1': 92, 'tone=filmic': 80, 'tone=aces&exposure=1': 198 }
    const wanted = { ...curves, 'vignette=0.5': 112 }
    for (const [look, value] of Object.entries(wanted)) {
      await open(`${SCENE}&${look}${grey}`)
      await page.waitForFunction(() => document.querySelector('fixsplat-viewer').shadowRoot.getElementById('look'))
      await pause(200)
      const [middle, edge] = await seen([[120, 180], [1, 180]])
      assert.ok(Math.abs(middle - value) <= 2, `${look}: ${middle}, and not ${value}`)
      assert.ok(Math.abs(edge - (/vignette/.test(look) ? 64 : value)) <= 3, `${look}: ${edge} at the edge`)
      assert.equal(await hash(), native('scene.fxs', await viewOf(), '640x360', '808080'))
    }
    await inside(`v.settings = { vignette: null, tone: 'filmic', exposure: 0.5 }`)
    assert.match(await inside('return v.link'), /tone=filmic&exposure=0.5/)
    await inside(`v.settings = { tone: 'linear', exposure: 0 }`)
    await pause(200)
    assert.deepEqual([await seen([[1, 180]]), await inside('return v.link.includes("tone")')], [[128], false])
  },

  async 'without a network: words, and the scene when the network is there'() {
    const late = `${scenes}/late.ply`
    await without(
      () => Object.defineProperty(Navigator.prototype, 'onLine', { configurable: true, get: () => false }),
      async () => {
        await go('?scene=http://127.0.0.1:9/scene.ply')
        assert.match(await wordsOf(), /^This machine is not connected.*loaded when it is$/)
        await go('?scene=/scenes/late.ply')
        await wordsOf()
        copyFileSync(`${scenes}/scene.ply`, late)
        await page.evaluate(() => dispatchEvent(new Event('online')))
        await still()
        assert.equal(await inside(`return $('error').hidden`), true)
        assert.equal(await hash(), native('scene.fxs', await viewOf(), '640x360'))
      }
    )
    rmSync(late)
  },

  async 'too little memory for a picture: a smaller one, and words'() {
    const begin = 'async draw(id, camera, options, moves) {'
    const least = 'if (options.width * options.height > 1e5) throw new Error("out of memory");'
    await changed(
      '/viewer/worker.js',
      (text) => text.replace(begin, `${begin}${least}`),
      async () => {
        await open(SCENE)
        assert.match(await inside(`return $('note').textContent`), /too little memory/)
        const { size } = await shown()
        assert.ok(size[0] * size[1] <= 1e5 && size[0] * size[1] > 3e4, size)
        await page.keyboard.press('ArrowLeft', { delay: 60 })
        await moved()
      }
    )
  },

  async 'nothing is drawn in a hidden tab; the right picture when it is shown again'() {
    await open(SCENE)
    await inside(`v.drawn = 0; v.addEventListener('frame', () => v.drawn++); v.hide = (is) => {
      Object.defineProperty(document, 'hidden', { configurable: true, get: () => is })
      document.dispatchEvent(new Event('visibilitychange')) }
      v.hide(true)`)
    const before = await viewOf()
    await page.keyboard.press('ArrowLeft', { delay: 60 })
    await pause(500)
    assert.notEqual(await viewOf(), before)
    assert.equal(await inside('return v.drawn'), 0)
    await inside('v.hide(false)')
    await moved()
    assert.equal(await hash(), native('scene.fxs', await viewOf(), '640x360'))
  },

  async 'a poster until the first picture'() {
    await go(`${SCENE}?slow&poster=/scenes/poster.png`)
    const shows = () => document.querySelector('fixsplat-viewer').shadowRoot.querySelector('img')?.complete
    await page.waitForFunction(shows)
    assert.equal(await inside(`return $('stage').lastElementChild.naturalWidth`), 64)
    await picture('poster')
    await still()
    await pause(300)
    assert.equal(await inside(`return $('stage').lastElementChild.localName`), 'canvas')
  },

  async 'views beside the axis and with parallel rays, and their links'() {
    await open(`${SCENE}&cameras=/scenes/more.json`)
    const again = async () => {
      const first = await hash()
      const { search, hash: view } = new URL(await inside('return v.link'))
      await open(`${search}${view}`)
      assert.equal(await hash(), first)
      return first
    }
    const views = ['--cameras', `${scenes}/more.json`, '--bg', '0e1116']
    assert.equal(await again(), rendered('scene.fxs', ...views))
    await page.keyboard.press('n')
    await moved()
    assert.equal(await again(), rendered('scene.fxs', ...views, '--view', '1'))
    const wide = (await numbersOf())[9]
    await page.keyboard.press('+')
    await moved()
    assert.ok((await numbersOf())[9] < wide)
    await inside(`$('set').click(); v.shadowRoot.querySelector('[name=flat]').click()`)
    await moved()
    assert.equal((await numbersOf()).length, 10)
    assert.equal(await hash(), native('scene.fxs', await viewOf(), '640x360'))
  },

  async 'flight: pointers look, keys and the wheel move; the mode is shown'() {
    await open(SCENE)
    await page.keyboard.press('2')
    await moved()
    assert.deepEqual(await inside(`return ['orbit', 'fly'].map((id) => $(id).getAttribute('aria-pressed'))`), [
      'false',
      'true',
    ])
    assert.match(await inside(`return $('list').textContent`), /look around/)
    const drag = async () => {
      const before = await numbersOf()
      await page.mouse.move(320, 180)
      await page.mouse.down()
      await page.mouse.move(380, 150, { steps: 4 })
      await page.mouse.up()
      await moved()
      return [before, await numbersOf()]
    }
    const [before, looked] = await drag()
    assert.deepEqual(looked.slice(0, 3), before.slice(0, 3))
    assert.notDeepEqual(looked.slice(3, 6), before.slice(3, 6))
    for (const act of [
      () => page.keyboard.press('w', { delay: 60 }),
      () => page.mouse.wheel({ deltaY: -300 }),
    ]) {
      const [x, y, z] = await numbersOf()
      await act()
      await moved()
      assert.notDeepEqual((await numbersOf()).slice(0, 3), [x, y, z], String(act))
    }
    await inside(`$('orbit').click()`)
    const [, turned] = await drag()
    assert.notDeepEqual(turned.slice(0, 3), looked.slice(0, 3))
  },

  async 'it turns by itself when it is asked to; the readout'() {
    await open(`${SCENE}&turn`)
    await inside(`v.shadowRoot.querySelector('[name=readout]').click()`)
    await page.waitForSelector('fixsplat-viewer[state=moving]', { timeout: 20000 })
    const before = await viewOf()
    await pause(700)
    assert.notEqual(await viewOf(), before)
    assert.match(await inside(`return $('readout').textContent`), /a second, .* by the processor, \d+ × \d+/)
    await inside(`for (let i = 0; i < 8; i++) v.toggleAttribute('turn')`)
    const angles = []
    for (let i = 0; i < 2; i++) {
      await pause(700)
      angles.push(
        await inside(`const [x, , z, lx, , lz] = v.view.split(',');
          return [Math.atan2(x - lx, z - lz), performance.now()]`)
      )
    }
    const [[from, start], [to, end]] = angles
    const turned = Math.abs(Math.atan2(Math.sin(to - from), Math.cos(to - from)))
    assert.ok(turned > 0 && turned < (0.4 * (end - start)) / 1000, turned)
    await inside(`v.removeAttribute('turn')`)
    await moved()
    await page.keyboard.press('0')
    await moved()
  },

  async 'captured scenes, and motion at a fraction of the size'() {
    const list = {
      guitar: 'guitar.compressed.ply',
      snowmiku: 'snowmiku.ply&cameras=/scenes/real/snowmiku/cameras.json',
    }
    if (pictures === scenes) delete list.guitar
    for (const [folder, file] of existsSync(`${scenes}/real`) ? Object.entries(list) : []) {
      await without(
        () => addEventListener('frame', ({ target }) => (window.first ??= target.state), true),
        () => go(`?scene=/scenes/real/${folder}/${file}`, 1280, 720)
      )
      await page.waitForFunction(() => window.first, { polling: 20, timeout: 120000 })
      await picture(`${folder}-first`)
      await still()
      if (folder === 'snowmiku') assert.equal(await page.evaluate(() => window.first), 'loading')
      await picture(folder)
      assert.equal(await hash(), native(`real/${folder}/${file.split('&')[0]}`, await viewOf(), '1280x720'))
      await inside(
        `v.seen = []; v.addEventListener('frame', ({ detail }) =>
          v.seen.push([detail.divisor, Math.round(detail.milliseconds)]))`
      )
      await page.keyboard.press('ArrowLeft', { delay: 1500 })
      await moved()
      const seen = await inside('return v.seen')
      console.log(
        `  ${folder}: divisor, ms: ${seen.slice(0, 3).join(' | ')} ... ${seen.slice(-3).join(' | ')}; ` +
          `${seen.length} pictures in 1.5 s`
      )
      assert.equal(seen.at(-1)[0], 1)
      assert.ok(seen.at(-1)[1] < 60 || seen.some(([divisor]) => divisor > 1))
    }
  },

  async 'pictures of the page'() {
    await open(SCENE, 1280, 720)
    await picture('desktop')
    await page.keyboard.press('h')
    await picture('desktop-keys')
    await page.emulateMediaFeatures([{ name: 'prefers-color-scheme', value: 'light' }])
    await page.keyboard.press('Escape')
    await inside(`$('set').click()`)
    await moved()
    await picture('light')
  },
}

await run({ ...tests, ...walking })
