// node moving.mjs PACKAGE SCENES MODULES PICTURES COMMAND: checks moving scenes in the viewer's page. Its pictures at a
// time must equal those of the command-line program COMMAND.
import assert from 'node:assert/strict'
import { execFileSync } from 'node:child_process'
import { mkdirSync, writeFileSync } from 'node:fs'
import * as chromium from './chromium.mjs'
import { base, go, hash, inside, moved, native, open, page, pause, picture, scenes, viewOf } from './chromium.mjs'

const { command, folder, ranges, run } = chromium

const FRAMES = 30
const EACH = 1500
const NAMES = 'x y z f_dc_0 f_dc_1 f_dc_2 opacity scale_0 scale_1 scale_2 rot_0 rot_1 rot_2 rot_3'.split(' ')

let state = 1
function uniform(low, high) {
  state = (Math.imul(state, 1664525) + 1013904223) >>> 0
  return low + (high - low) * state / 2 ** 32
}

const numbers = (count, low, high) => Array.from({ length: count }, () => uniform(low, high))
const fresh = () => [...numbers(3, -2, 2), ...numbers(3, -1.5, 1.5), 2, ...numbers(3, -3.5, -2.5), ...numbers(4, -1, 1)]

/** Writes a scene of frames of which a Gaussian each is seen for half a second, and the same as one file. */
function makeScene() {
  const folder = `${scenes}/frames`
  const all = Array.from({ length: EACH }, fresh)
  const ways = all.map(() => numbers(3, -0.03, 0.03))
  const head = NAMES.map((name) => `property float ${name}\n`).join('')
  mkdirSync(folder)
  for (let frame = 0; frame < FRAMES; frame++) {
    all.forEach((one, i) => {
      if (i % 15 === frame % 15) all[i] = fresh()
      else for (let axis = 0; axis < 3; axis++) one[axis] += ways[i][axis]
    })
    const text = `ply\nformat binary_little_endian 1.0\nelement vertex ${EACH}\n${head}end_header\n`
    const body = Buffer.from(Float32Array.from(all.flat()).buffer)
    writeFileSync(`${folder}/frame${1000 + frame}.ply`, Buffer.concat([Buffer.from(text), body]))
  }
  execFileSync(command, ['convert', folder, `${scenes}/moving.fxs`, '--quiet'])
  execFileSync(command, ['convert', `${folder}/frame1000.ply`, `${scenes}/still.fxs`, '--quiet'])
}

const WHOLE = '?scene=/scenes/moving.fxs&background=%23102030'
const PARTS = '?scene=/scenes/moving.fxs%3Franges&background=%23102030'
const CARD = process.env.WEBGPU ? [WHOLE, PARTS].map((address) => `${address}&backend=webgpu`) : []
const [FRONT, SIZE] = ['#view=0,0,-7,0,0,0,0,-1,0,45', '640x360']

const until = (what, timeout = CARD.length ? 120000 : 30000) =>
  page.waitForFunction(`(() => { const v = document.querySelector('fixsplat-viewer')
    const $ = (id) => v.shadowRoot.getElementById(id); return ${what} })()`, { timeout })

async function plays(address, ...size) {
  await go(address, ...size)
  await until('v.playing')
}

/** Checks the picture at rest against the command's at the same time. */
async function isExact() {
  await moved()
  const time = await inside('return v.time')
  const wanted = native('moving.fxs', await viewOf(), SIZE, '102030', '--time', `${time}`)
  for (let i = 0; (await hash()) !== wanted; i++) assert.ok(i < 40, `another picture than ${wanted} at ${time} s`)
  return time
}

const seekTo = (time) => inside('v.pause(); v.seek(args[0])', time)

makeScene()
const tests = {
  async 'a moving scene plays by itself; paused, it has the pixels of the command'() {
    for (const address of CARD.length ? CARD : [WHOLE, PARTS, `${WHOLE}&backend=webgl2`]) {
      await plays(`${address}&loop=none${FRONT}`)
      const told = await inside(`const times = []
        v.addEventListener('timeupdate', ({ detail }) => times.push(detail.time))
        while (times.length < 5) await new Promise(requestAnimationFrame)
        return [times, v.duration, v.loop, v.speed, v.state, v.paused, $('mover').checkVisibility()]`)
      assert.deepEqual(told.slice(1), [1, false, 1, 'moving', false, true])
      assert.ok(told[0].every((time, i) => !i || time > told[0][i - 1]), `${told[0]}`)
      const hashes = new Set()
      for (const time of [undefined, 0, 0.25, 0.5, 0.7, 1]) {
        await inside('v.pause()')
        if (time !== undefined) await seekTo(time)
        const shown = await isExact()
        assert.ok(time === undefined || shown === time)
        hashes.add(await hash())
      }
      assert.ok(hashes.size >= 5)
    }
    await picture('moving')
  },

  async 'the bar, the keys and a finger'() {
    await plays(`${WHOLE}&loop${FRONT}`)
    await inside(`$('stage').focus()`)
    await page.keyboard.press('k')
    assert.equal(await inside('return v.playing'), false)
    await seekTo(0.5)
    const steps = []
    for (const key of ['.', '.', ',']) {
      await page.keyboard.press(key)
      steps.push(Math.round(FRAMES * (await inside('return v.time'))))
    }
    assert.deepEqual(steps, [16, 17, 16])
    await isExact()
    for (const key of [']', ']', '[', 'y']) await page.keyboard.press(key)
    assert.deepEqual(await inside('return [v.speed, v.loop]'), [2, false])
    await page.keyboard.press('y')
    await inside(`$('on').click()`)
    assert.equal(Math.round(FRAMES * (await inside('return v.time'))), 17)
    for (let i = 0; i < 2; i++) await inside(`v.seek(0); $('back').click()`)
    assert.equal(Math.round(FRAMES * (await inside('return v.time'))), FRAMES - 1)
    const middle = await inside(`const { x, y, width, height } = $('moment').getBoundingClientRect()
      return [x + width / 2, y + height / 2]`)
    await page.touchscreen.tap(...middle)
    await until('Math.abs(v.time - 0.5) < 0.05')
    await isExact()
    await inside(`$('moment').focus()`)
    await page.keyboard.press('K')
    await until('v.playing')
    await inside(`$('run').click(); $('pace').value = '0.25'; $('pace').dispatchEvent(new Event('change'))`)
    assert.deepEqual(await inside(`$('again').click(); return [v.playing, v.speed, v.loop, v.getAttribute('loop')]`),
      [false, 0.25, false, 'none'])
    assert.deepEqual(await inside(`v.speed = 3; v.loop = true
      return [v.speed, $('pace').value, v.loop, $('again').getAttribute('aria-pressed')]`), [3, '3', true, 'true'])
  },

  async 'it ends, or starts again; as fast as asked'() {
    await go(`${WHOLE}&playing=false&speed=2&loop=none`)
    await until(`v.state === 'still' && $('mover')`)
    await pause(300)
    assert.deepEqual(await inside('return [v.playing, v.time]'), [false, 0])
    const took = await inside(`const began = performance.now(), told = []
      const tell = ({ type, detail }) => told.push(type, detail.track)
      for (const name of ['play', 'pause', 'ended']) v.addEventListener(name, tell)
      await v.play()
      while (v.playing) await new Promise(requestAnimationFrame)
      return [performance.now() - began, v.time, told.join()]`)
    assert.deepEqual(took.slice(1), [1, 'play,,pause,,ended,'])
    assert.ok(took[0] > 450 && took[0] < 1500, `${took[0]} ms`)
    await isExact()
    const times = await inside(`v.loop = true; await v.play()
      const times = []
      v.addEventListener('timeupdate', ({ detail }) => times.push(detail.time))
      while (times.filter((time, i) => i && time < times[i - 1]).length < 2) await new Promise(requestAnimationFrame)
      v.playing = false
      return times`)
    assert.ok(times.every((time) => time >= 0 && time < 1), `${times}`)
  },

  async 'a link shows the moment; less motion: it waits'() {
    await plays(`${WHOLE}&speed=0.5${FRONT}`)
    await seekTo(0.625)
    await isExact()
    const [first, link] = [await hash(), new URL(await inside('return v.link'))]
    await open(`${link.search}${link.hash}`)
    await isExact()
    assert.deepEqual([await hash(), await inside('return [v.time, v.playing, v.speed]')], [first, [0.625, false, 0.5]])
    const features = (motion) => page.emulateMediaFeatures([
      { name: 'prefers-color-scheme', value: 'dark' }, { name: 'prefers-reduced-motion', value: motion }])
    await features('reduce')
    await open(`${WHOLE}&time=0.4`)
    await pause(500)
    assert.deepEqual(await inside('return [v.playing, v.time]'), [false, 0.4])
    await inside('await v.play()')
    await until('v.playing && v.time > 0.5')
    await features('no-preference')
  },

  async 'a still scene has no bar; a scene that follows a moving one'() {
    await open('?scene=/scenes/still.fxs')
    assert.deepEqual(await inside(`return [$('mover'), v.duration, v.playing, v.time]`), [null, 0, false, 0])
    await plays(WHOLE)
    await inside(`await v.open('/scenes/still.fxs')`)
    await until(`v.state === 'still'`)
    assert.deepEqual(await inside(`return [$('mover').hidden, v.duration, v.playing]`), [true, 0, false])
    await inside(`await v.open('/scenes/moving.fxs')`)
    await until('v.playing && v.time > 0')
    await inside(`v.add('/scenes/moving.fxs', { position: '5 0 0', time: 0.5 })`)
    await until('v.scenes.length === 2')
    await inside('v.pause()')
    await moved()
  },

  async 'parts come before they are seen; a time that is far comes soon'() {
    ranges.sent = 0
    ranges.rate = 1.5e6
    await go(`${PARTS}&loop${FRONT}`)
    await inside(`window.lacks = []; window.began = 0
      v.addEventListener('play', () => (window.began ||= performance.now()))
      v.addEventListener('frame', ({ detail }) => window.lacks.push([performance.now(), detail.missing]))`)
    await until('window.began && performance.now() > window.began + 3000', 60000)
    const late = await inside(`const late = ([at, missing]) => at > window.began + 1000 && missing
      return window.lacks.filter(late).length`)
    assert.equal(late, 0)
    await go(`${PARTS.replace('ranges', 'ranges%26more')}&playing=false${FRONT}`)
    await until(`v.state === 'still'`)
    const { sent } = ranges
    const took = await inside(`const began = performance.now()
      const next = () =>
        new Promise((done) => v.addEventListener('frame', ({ detail }) => done(detail.missing), { once: true }))
      v.seek(0.8)
      while (await next());
      return performance.now() - began`)
    console.log(`   ${sent} bytes before, then ${Math.round(took)} ms`)
    delete ranges.rate
    await isExact()
  },

  async 'a published scene: its poster, then it plays'() {
    const env = { ...process.env, FIXSPLAT_WEB: folder }
    const site = `${scenes}/site`
    execFileSync(command, ['publish', `${scenes}/moving.fxs`, site, '--size', '320x180', '--quiet'], { env })
    await page.goto('about:blank')
    await page.goto(`${base}/scenes/site/index.html`)
    await until(`v.shadowRoot && $('stage').querySelector('img, canvas')`)
    await until('v.playing && v.time > 0.1')
    await seekTo(0.3)
    await moved()
    const wanted = native('site/moving.fxs', await viewOf(), SIZE, '000000', '--time', '0.3')
    for (let i = 0; (await hash()) !== wanted; i++) assert.ok(i < 40, `another picture than ${wanted}`)
    await picture('moving-published')
  },

  async 'narrow and wide pictures of the bar'() {
    for (const [width, height] of [[360, 640], [1280, 720]]) {
      await plays(`${WHOLE}${FRONT}`, width, height)
      await seekTo(0.4)
      await moved()
      await picture(`moving-${width}`)
      const isIn = await inside(`const { left, right } = $('mover').getBoundingClientRect()
        return left >= 0 && right <= innerWidth`)
      assert.ok(isIn)
    }
    await plays(`${WHOLE}&ui=motion`)
    assert.deepEqual(await inside(`return [$('mover'), $('full')].map((one) => one.checkVisibility())`), [true, false])
    await plays(`${WHOLE}&noui`)
    assert.equal(await inside(`return $('mover').checkVisibility()`), false)
  },
}

await run(tests)
