// node xr.mjs PACKAGE SCENES NODE_MODULES PICTURES COMMAND: checks virtual and augmented reality (WebXR) in the viewer,
// with the simulated devices of the package iwer.
import assert from 'node:assert/strict'
import { readFileSync } from 'node:fs'
import { resolve } from 'node:path'
import { pathToFileURL } from 'node:url'
import {
  base, changed, engineOf, faults, folder, go, inside, modules, page, rendered, run, scenes, still,
} from './chromium.mjs'

const { load } = await import(pathToFileURL(resolve(folder, 'fixsplat.js')))
const iwer = readFileSync(resolve(modules, 'iwer/build/iwer.min.js'), 'utf8')

const [width, height] = [320, 160]
const VIEW = '0,-2,-9,0,-2,-7,0,-1,0,50'

/** Simulates a headset with diverging eyes and a controlled clock. Runs before the script of the viewer's page. */
function prepare() {
  const device = new IWER.XRDevice(IWER.metaQuest3, { stereoEnabled: true, ipd: 0.0625, visibilityMask: null })
  device.installRuntime({ forceInstall: true })
  const { get } = Object.getOwnPropertyDescriptor(XRView.prototype, 'projectionMatrix')
  Object.defineProperty(XRView.prototype, 'projectionMatrix', {
    get() {
      const matrix = get.call(this).slice()
      matrix[8] = this.eye === 'left' ? -0.25 : 0.25
      matrix[9] = 0.125
      return matrix
    },
  })
  const test = (window.test = { device, delay: 0, seen: [] })
  const clock = performance.now.bind(performance)
  let [from, rate, base] = [0, 1, 0]
  performance.now = () => base + rate * (clock() - from)
  test.run = (times) => ([base, from, rate] = [performance.now(), clock(), times])
  test.skip = (milliseconds) => (base += milliseconds)
  const { getContext } = HTMLCanvasElement.prototype
  HTMLCanvasElement.prototype.getContext = function (kind, how) {
    const context = getContext.call(this, kind, { ...how, preserveDrawingBuffer: true })
    return how?.xrCompatible ? (test.gl = context) : context
  }
  const { postMessage } = Worker.prototype
  Worker.prototype.postMessage = function (message, ...more) {
    const late = message.word === 'eyes' ? test.delay : 0
    if (late) setTimeout(() => postMessage.call(this, message, ...more), late)
    else postMessage.call(this, message, ...more)
  }
  addEventListener('eyes', ({ detail }) => test.seen.push(detail), true)
  test.pixels = () => {
    const { gl } = test
    const [w, h] = [gl.drawingBufferWidth, gl.drawingBufferHeight]
    const rows = new Uint8Array(4 * w * h)
    gl.bindFramebuffer(gl.FRAMEBUFFER, null)
    gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, rows)
    const pixels = new Uint8Array(rows.length)
    for (let y = 0; y < h; y++) pixels.set(rows.subarray(4 * w * (h - 1 - y), 4 * w * (h - y)), 4 * w * y)
    return pixels
  }
}

function prepareRoom() {
  const { test } = window
  Object.assign(test, { isPhone: false, heights: [0], finds: true, hasFloor: true, hasPage: true, asked: [] })
  test.phone = (is) => {
    test.isPhone = is
    Object.assign(test.device, { stereoEnabled: !is, ipd: is ? 0 : 0.0625 })
  }
  const change = (object, name, how) => {
    const own = object[name]
    object[name] = function (...args) {
      return how.call(this, own.bind(this), ...args)
    }
  }
  const refuse = () => Promise.reject(new DOMException('none', 'NotSupportedError'))
  change(navigator.xr, 'requestSession', async (ask, mode, options) => {
    test.asked.push({ mode, ...options, root: options?.domOverlay?.root.id })
    const session = await ask(mode, options)
    if (mode === 'immersive-ar' && test.hasPage) session.domOverlayState = { type: 'screen' }
    return session
  })
  change(XRSession.prototype, 'requestReferenceSpace', (ask, name) =>
    name === 'local-floor' && !test.hasFloor ? refuse() : ask(name))
  XRSession.prototype.requestHitTestSource = async (source) => (test.finds ? source : refuse())
  const hit = (...place) => ({ getPose: () => ({ transform: new XRRigidTransform(...place) }) })
  XRFrame.prototype.getHitTestResults = function ({ space }) {
    const wall = hit({ x: 0, y: 1.5, z: -0.1 }, { x: Math.SQRT1_2, y: 0, z: 0, w: Math.SQRT1_2 })
    const { matrix: m, position: p } = this.getPose(space, test.space).transform
    const level = test.heights.map((y) => ({ y, far: (p.y - y) / m[9] })).filter(({ far }) => far > 0 && far < 100)
    return [wall, ...level.map(({ y, far }) => hit({ x: p.x - far * m[8], y, z: p.z - far * m[10] }))]
  }
  change(XRFrame.prototype, 'getViewerPose', (ask, space) => {
    const { transform, views } = ask((test.space = space))
    return { transform, views: test.isPhone ? views.slice(0, 1) : views }
  })
  const { get } = Object.getOwnPropertyDescriptor(XRInputSource.prototype, 'targetRayMode')
  Object.defineProperty(XRInputSource.prototype, 'targetRayMode', {
    get() {
      return test.isPhone ? 'screen' : get.call(this)
    },
  })
}

page.on('console', (said) => said.type() === 'error' && faults.push(said.text()))
const { identifier } = await page.evaluateOnNewDocument(`${iwer};(${prepare})();(${prepareRoom})()`)

const until = (expression) =>
  page.waitForFunction(`(() => { const v = document.querySelector('fixsplat-viewer');
    const $ = (id) => v.shadowRoot.getElementById(id);
    return ${expression} })()`, { timeout: 30000 })

async function open(backend) {
  await go(`?scene=/scenes/scene.ply&background=%23102030&backend=${backend}#view=${VIEW}`, width, height)
  await still()
}

async function enter() {
  await until(`!$('headset').hidden`)
  await inside(`test.seen = []; $('headset').click(); $('headset').click()`)
  await until(`v.hasAttribute('headset') && test.seen.length`)
  await inside('test.run(0.01)')
}

async function enterRoom(taps) {
  await until(`!$('room').hidden`)
  await inside(`test.seen = []; $('room').click()`)
  await until(`v.hasAttribute('headset')`)
  await inside('test.run(0.01)')
  if (!taps) return
  await hint(/^Tap/)
  await touch('right', 1)
  await touch('right', 0)
  await drawn()
}

async function drawn() {
  await inside('test.seen = []')
  await until('test.seen.length > 2')
}

async function settle() {
  await drawn()
  await until('test.seen.at(-1).scale === 1')
  await inside('for (let i = 0; i < 2; i++) await new Promise(requestAnimationFrame)')
}

async function leave() {
  await inside('test.run(1); test.device.activeSession.end()')
  await until(`!v.hasAttribute('headset')`)
}

const pose = (position, left = 0, up = 0) =>
  inside(
    `test.device.position.set(...args[0]);
    const [a, b] = [args[1] / 2, args[2] / 2].map((d) => d * Math.PI / 180);
    test.device.quaternion.set(Math.cos(a) * Math.sin(b), Math.sin(a) * Math.cos(b),
      -Math.sin(a) * Math.sin(b), Math.cos(a) * Math.cos(b))`,
    position,
    left,
    up
  )
const stick = (hand, ...at) =>
  inside(`test.device.controllers[args[0]].updateAxes('thumbstick', ...args[1])`, hand, at)
const hand = (name, ...at) => inside(`test.device.controllers[args[0]].position.set(...args[1])`, name, at)
const grip = (name, value) =>
  inside(`test.device.controllers[args[0]].updateButtonValue('squeeze', args[1])`, name, value)
const frames = (body, ...args) =>
  inside(`${body}; for (let i = 0; i < 2; i++) await new Promise(requestAnimationFrame)`, ...args)
const touch = (name, value) =>
  frames(`test.device.controllers[args[0]].updateButtonValue('trigger', args[1])`, name, value)
const drag = (...fingers) =>
  inside(`const frames = async () => { for (let i = 0; i < 2; i++) await new Promise(requestAnimationFrame) }
    const all = args.map(([name, ...places]) => [test.device.controllers[name], ...places])
    const point = (one, place) => {
      const [a, b] = place.map((d) => (d / 2) * Math.PI / 180)
      one.position.copy(test.device.position)
      one.quaternion.set(Math.cos(a) * Math.sin(b), Math.sin(a) * Math.cos(b), -Math.sin(a) * Math.sin(b),
        Math.cos(a) * Math.cos(b))
    }
    for (const [one, from] of all) point(one, from), one.updateButtonValue('trigger', 1)
    await frames()
    for (const [one, , to] of all) point(one, to)
    await frames()
    for (const [one] of all) one.updateButtonValue('trigger', 0)
    await frames()`, ...fingers)
const hint = (words) => until(`${words}.test($('inRoom').firstChild.textContent)`)

const pixels = async () =>
  Buffer.from(await inside(`return btoa(test.pixels().reduce((s, b) => s + String.fromCharCode(b), ''))`), 'base64')
const cameras = () => inside('return test.seen.at(-1).cameras')
const eyeOf = ([left, right]) => left.position.map((x, i) => (x + right.position[i]) / 2)

function hash(bytes) {
  let h = 0xcbf29ce484222325n
  for (const byte of bytes) h = BigInt.asUintN(64, (h ^ BigInt(byte)) * 0x100000001b3n)
  return h.toString(16).padStart(16, '0')
}

const BETWEEN = ['--eye', '0,-2,-9', '--look', '0,-2,-7', '--near', '0.1', '--size', `${width / 2}x${height}`]
const APART = ['--stereo', '0.0625', '--tangents', '-1.25,0.75,1.125,-0.875', '--bg', '102030']

const native = () => rendered('scene.ply', ...BETWEEN, ...APART)

const scene = await load(`${scenes}/scene.ply`)
function packaged(pair, how) {
  const eyes = scene.renderStereo(...pair, { width: width / 2, height, background: 0x102030, ...how })
  const row = (pixels, y) => Buffer.from(pixels.buffer, 2 * width * y, 2 * width)
  return Buffer.concat(Array.from({ length: height }, (_, y) => eyes.map((eye) => row(eye, y))).flat())
}

async function seenThrough() {
  await engineOf().evaluate(() => (self.bitmaps = 0))
  await inside('test.finds = false')
  await pose(EYE, 30, -25)
  await enterRoom(false)
  await settle()
  const clear = await pixels()
  assert.ok(Buffer.compare(clear, packaged(await cameras(), { alpha: true })) === 0)
  assert.ok(clear.some((byte, i) => i % 4 === 3 && byte > 0 && byte < 255), 'nothing half transparent')
  assert.ok(await engineOf().evaluate(() => self.bitmaps > 2), 'the processor drew')
  await leave()
  await pose([0, 1.6, 0])
}

function likeness(a, b) {
  let sum = 0
  for (let i = 0; i < a.length; i++) sum += (a[i] - b[i]) ** 2
  return 10 * Math.log10(255 ** 2 / (sum / a.length))
}
const near = (a, b, most = 1e-6) => a.forEach((x, i) => assert.ok(Math.abs(x - b[i]) < most, `${a}, not ${b}`))

function direction(left, up) {
  const [a, b] = [left, up].map((degrees) => (degrees * Math.PI) / 180)
  return [-Math.sin(a) * Math.cos(b), Math.sin(b), -Math.cos(a) * Math.cos(b)]
}
const onTable = (eye, along) => eye.map((x, i) => x + ((HEIGHT - eye[1]) / along[1]) * along[i])

/** Converts a vector in the user's room to the scene's axes. When the scene was placed, the user at `eye` looked at the
   place `foot`. */
function inScene([x, y, z], eye, foot, turn, units) {
  const [hx, hz] = [foot[0] - eye[0], foot[2] - eye[2]].map((part, _, all) => part / Math.hypot(...all))
  const [c, s] = [Math.cos(turn), Math.sin(turn)]
  const [a, b] = [c * x - s * z, s * x + c * z]
  return [-a * hz + b * hx, -y, a * hx + b * hz].map((part) => part * units)
}

const middle = () => [0, 1, 2].map((i) => (i === 1 ? scene.high[i] : (scene.low[i] + scene.high[i]) / 2))
const longest = Math.max(...scene.high.map((x, i) => x - scene.low[i]))
const TABLE = 2 * longest // scene units per metre on a table, where the scene's longest side becomes half a metre

function stands({ position, rotation }, eye, looks, { at, put = at, from = eye, turn = 0, units = TABLE }) {
  const to = inScene(eye.map((x, i) => x - at[i]), from, put, turn, units)
  near(position, middle().map((x, i) => x + to[i]), 1e-4)
  near(rotation.map((row) => row[2]), inScene(direction(...looks), from, put, turn, 1), 1e-4)
}

const EYE = [0.4, 1.6, 0.2]
const LOOKS = [30, -45]
const HEIGHT = 0.9
const BEFORE = 0.7

const tests = {
  async 'both eyes: the pixels of the command'() {
    await open('wasm')
    await enter()
    await settle()
    const pair = await cameras()
    assert.deepEqual(pair.map(({ position }) => position), [[-0.03125, -2, -9], [0.03125, -2, -9]])
    assert.equal(hash(await pixels()), native())
    assert.equal(hash(packaged(pair)), native())
    const isCopied = await inside(`const { gl } = test, program = gl.getParameter(gl.CURRENT_PROGRAM);
      return gl.getUniform(program, gl.getUniformLocation(program, 'same'))`)
    assert.ok(isCopied, 'taken through a filter')
  },

  async 'the head moves and turns'() {
    await pose([0.5, 1.85, 2])
    await settle()
    near(eyeOf(await cameras()), [0.5, -2.25, -11], 1e-6)
    await pose([0.5, 1.85, 2], -20, 10)
    await settle()
    const pair = await cameras()
    const ahead = pair[0].rotation.map((row) => row[2])
    assert.ok(ahead[0] > 0.3 && ahead[1] < -0.15 && ahead[2] > 0.9, `${ahead}`)
    assert.ok(Buffer.compare(await pixels(), packaged(pair)) === 0)
  },

  async 'a late picture is moved to where the head is'() {
    for (const [position, left] of [[[0, 1.6, 0], 5], [[0.3, 1.7, -0.5], 0]]) {
      await pose([0, 1.6, 0])
      await settle()
      const before = await pixels()
      await inside('test.delay = 800; test.seen = []')
      await until('test.seen.length')
      await pose(position, left)
      await inside('for (let i = 0; i < 3; i++) await new Promise(requestAnimationFrame)')
      const late = await pixels()
      await inside('test.delay = 0')
      await settle()
      const exact = await pixels()
      assert.ok(Buffer.compare(exact, packaged(await cameras())) === 0)
      const [moved, not] = [likeness(late, exact), likeness(before, exact)]
      console.log(`  moved ${moved.toFixed(1)} dB, as it was ${not.toFixed(1)} dB of the picture of the pose`)
      assert.ok(moved > 21 && moved > not + 4, `${moved} and ${not} dB`)
    }
  },

  async 'thumbsticks move and turn'() {
    await pose([0, 1.6, 0])
    await settle()
    const start = await cameras()
    await stick('left', 0, -1)
    await inside('test.seen = []')
    await until('test.seen.length > 3')
    await stick('left', 0, 0)
    await settle()
    const ahead = await cameras()
    assert.ok(eyeOf(ahead)[2] > eyeOf(start)[2] + 1e-4, `${eyeOf(ahead)}`)
    near(eyeOf(ahead).slice(0, 2), [0, -2])
    await stick('right', 1, 0)
    await settle()
    const right = await cameras()
    near(right[0].rotation.map((row) => row[2]), [0.5, 0, Math.sqrt(0.75)])
    near(eyeOf(right), eyeOf(ahead))
    await stick('right', 0, -1)
    await inside('test.seen = []')
    await until('test.seen.length > 3')
    await stick('right', -1, 0)
    await settle()
    const higher = await cameras()
    near(higher[0].rotation.map((row) => row[2]), [0, 0, 1])
    assert.ok(eyeOf(higher)[1] < eyeOf(ahead)[1] - 1e-4)
    await stick('right', 0, 0)
  },

  async 'a grip pulls; two make the scene larger'() {
    const start = eyeOf(await cameras())
    await hand('right', 0, 1, -0.5)
    await grip('right', 1)
    await settle()
    near(eyeOf(await cameras()), start)
    await hand('right', 0.25, 1, -0.5)
    await settle()
    near(eyeOf(await cameras()), [start[0] - 0.25, start[1], start[2]], 1e-4)
    await hand('left', -0.25, 1, -0.5)
    await grip('left', 1)
    await settle()
    const apart = ([left, right]) => Math.hypot(...left.position.map((x, i) => x - right.position[i]))
    near([apart(await cameras())], [0.0625], 1e-4)
    await hand('left', -0.75, 1, -0.5)
    await settle()
    near([apart(await cameras())], [0.03125], 1e-3)
    for (const name of ['left', 'right']) await grip(name, 0)
  },

  async 'recentring goes back to the start'() {
    await inside('test.device.recenter()')
    await settle()
    near(eyeOf(await cameras()), [0, -2, -9])
  },

  async 'slow pictures are smaller; quick ones larger again'() {
    await inside('test.run(100)')
    await until('test.seen.at(-1).scale === 0.35')
    assert.equal(await inside('return test.seen.at(-1).width'), 56 + 2 * 7)
    await inside('test.run(0.01)')
    await until('test.seen.at(-1).scale === 1')
  },

  async 'blurred, hidden, and back'() {
    for (const state of ['visible-blurred', 'hidden', 'visible']) {
      await inside('test.device.updateVisibilityState(args[0])', state)
      await inside('for (let i = 0; i < 3; i++) await new Promise(requestAnimationFrame)')
    }
    await settle()
  },

  async 'the page goes on after the session; a second one'() {
    await leave()
    await page.keyboard.press('ArrowLeft', { delay: 60 })
    await until(`v.view !== '${VIEW}'`)
    await still()
    await inside(`v.setAttribute('view', ''); v.setAttribute('view', args[0])`, VIEW)
    await pose([3, 1, 1], 90)
    await enter()
    await settle()
    near(eyeOf(await cameras()), [0, -2, -9])
    near((await cameras())[0].rotation.map((row) => row[2]), [0, 0, 1])
    await leave()
  },

  async 'another scene, or a lost context, ends it; the page goes on'() {
    await enter()
    await inside('test.run(1)')
    await inside(`v.open(new URL('/scenes/scene.ply', location).href)`)
    await until(`!v.hasAttribute('headset')`)
    await still()
    await enter()
    await inside(`test.run(1); test.gl.getExtension('WEBGL_lose_context').loseContext()`)
    await until(`!v.hasAttribute('headset') && !$('error').hidden`)
    assert.match(await inside(`return $('words').textContent`), /headset: its graphics context was lost/)
    // ignores an error: the device simulator iwer reads the clear colour of the lost context
    faults.length = 0
    await inside(`$('closeError').click()`)
    await enter()
    await settle()
    await leave()
  },

  async 'AR: a ring on the table; a tap puts the scene there, upright'() {
    await inside(`test.phone(true); test.heights = []; test.asked = []; v.setAttribute('view', '')
      v.setAttribute('view', args[0])`, VIEW)
    await pose(EYE, ...LOOKS)
    await enterRoom(false)
    await hint(/^Point/)
    assert.ok((await pixels()).every((byte) => byte === 0), 'something before there is a surface')
    await inside('test.heights = [args[0]]', HEIGHT)
    await hint(/^Tap/)
    await frames('')
    const ring = await pixels()
    const at = (x, y) => [...ring.subarray(4 * (width * y + x)).subarray(0, 4)]
    assert.deepEqual([at(200, 90), at(160, 80), at(240, 90)].flat(), Array(12).fill(0), 'not around the axis of view')
    assert.ok([181, 182, 217, 218].every((x) => at(x, 90).join() === '255,255,255,255'), 'no ring')
    await touch('right', 1)
    await touch('right', 0)
    await settle()
    await hint(/^Drag/)
    assert.equal(await inside(`return $('inRoom').firstChild.hidden`), false)
    const [camera, ...others] = await cameras()
    assert.equal(others.length, 0)
    stands(camera, EYE, LOOKS, { at: onTable(EYE, direction(...LOOKS)) })
    const [{ mode, optionalFeatures, requiredFeatures, root }] = await inside('return test.asked')
    assert.deepEqual([mode, optionalFeatures, requiredFeatures, root],
      ['immersive-ar', ['local-floor', 'hit-test', 'dom-overlay'], undefined, 'inRoom'])
  },

  async 'AR: the room is seen through the picture'() {
    const [camera] = await cameras()
    const seen = await pixels()
    const own = scene.render(camera, { width, height, alpha: true })
    assert.ok(Buffer.compare(seen, Buffer.from(own.buffer)) === 0)
    const alphas = Array.from({ length: width * height }, (_, i) => seen[4 * i + 3])
    const clear = alphas.filter((a) => a === 0).length
    assert.ok(clear > 0.5 * alphas.length && alphas.some((a) => a === 255), `${clear} clear pixels`)
    assert.ok(seen.subarray(0, 4 * width).every((byte) => byte === 0), 'the first row is not clear')
    const ground = [0x3c, 0x78, 0xb4]
    const whole = scene.render(camera, { width, height, background: 0x3c78b4 })
    const over = (i) => seen[i] + ((255 - seen[i | 3]) * ground[i % 4]) / 255
    const far = [...whole].map((byte, i) => Math.abs(byte - over(i))).filter((_, i) => i % 4 < 3 && seen[i | 3])
    const most = far.reduce((a, b) => Math.max(a, b))
    const same = (100 * far.filter((one) => one <= 0.5).length) / far.length
    console.log(`  over a colour ${same.toFixed(2)} % are the page's bytes, the others at most ${most.toFixed(2)} away`)
    assert.ok(most <= 1.5, `${most}`)
  },

  async 'AR: fingers move, turn and scale; buttons'() {
    await inside('test.delay = 30')
    const put = onTable(EYE, direction(...LOOKS))
    await drag(['right', LOOKS, [20, -40]])
    await drawn()
    const at = onTable(EYE, direction(20, -40))
    stands((await cameras())[0], EYE, LOOKS, { at, put })
    await drag(['right', [80, -40], [70, -35]])
    await drawn()
    const turn = (4 * 10 * Math.PI) / 180
    stands((await cameras())[0], EYE, LOOKS, { at, put, turn })
    await pose(EYE, 0, 0)
    await drag(['left', [10, 0], [0, -20]], ['right', [-10, 0], [0, 20]])
    await drawn()
    const times = Math.tan(Math.PI / 9) / Math.tan(Math.PI / 18)
    const turned = { at, put, from: EYE, turn: turn + Math.PI / 2 }
    stands((await cameras())[0], EYE, [0, 0], { ...turned, units: TABLE / times })
    await frames(`$('roomSize').click()`)
    await drawn()
    stands((await cameras())[0], EYE, [0, 0], { ...turned, units: 1 })
    assert.equal(await inside(`return $('roomSize').textContent`), 'On the table')
    await inside(`$('roomAnew').click()`)
    await hint(/^Point/)
    await frames('test.skip(8000)')
    await touch('right', 1)
    await touch('right', 0)
    await drawn()
    stands((await cameras())[0], EYE, [0, 0], { at: [EYE[0], 0, EYE[2] - BEFORE - longest / 2], units: 1 })
    await frames('test.skip(8000)')
    assert.equal(await inside(`return $('inRoom').firstChild.hidden`), true)
    await inside('test.device.recenter()')
    await hint(/^Point/)
    assert.equal(await inside(`return $('inRoom').firstChild.hidden`), false)
  },

  async 'AR: the page is as it was after it; a second time too'() {
    await inside('test.delay = 0')
    assert.equal(await inside(`return $('inRoom').parentNode === v.shadowRoot && !$('inRoom').hidden`), true)
    await inside(`$('roomEnd').click()`)
    await until(`!v.hasAttribute('headset') && !$('inRoom')`)
    await inside('test.run(1)')
    await still()
    assert.equal(await inside('return v.view'), VIEW)
    assert.equal(await inside('return v.settings.ar'), 'table')
    await inside(`v.settings = { ar: 'true' }; test.hasPage = false`)
    await pose(EYE, ...LOOKS)
    await enterRoom(true)
    stands((await cameras())[0], EYE, LOOKS, { at: onTable(EYE, direction(...LOOKS)), units: 1 })
    assert.equal(await inside(`return $('inRoom').hidden`), true)
    await inside(`test.run(1); test.gl.getExtension('WEBGL_lose_context').loseContext()`)
    await until(`!v.hasAttribute('headset') && $('words').textContent === 'AR: its graphics context was lost'`)
    faults.length = 0
    await inside(`$('closeError').click(); v.setAttribute('ar', 'off')`)
    await until(`$('room').hidden && !$('headset').hidden`)
    await inside(`v.removeAttribute('ar')`)
  },

  async 'AR: in front of who looks, where no surface is known; both eyes of a headset'() {
    await inside('test.phone(false); test.finds = false')
    const check = async (eye, looks, height) => {
      await enterRoom(false)
      await drawn()
      const pair = await cameras()
      const [x, , z] = direction(looks[0], 0)
      const at = [eye[0] + (BEFORE + 0.25) * x, height, eye[2] + (BEFORE + 0.25) * z]
      stands({ ...pair[0], position: eyeOf(pair) }, eye, looks, { at })
    }
    await pose(EYE, ...LOOKS)
    await check(EYE, LOOKS, 0)
    await settle()
    assert.ok(Buffer.compare(await pixels(), packaged(await cameras(), { alpha: true })) === 0)
    await pose(EYE, 0, 0) // The device simulator iwer starts its next reference space at the device's pose.
    await drawn()
    await leave()
    await inside('test.hasFloor = false')
    await check([0, 0, 0], [0, 0], -1.2)
    await leave()
    await inside('test.finds = test.hasFloor = true')
  },

  async 'a scene that breaks off after its preview ends it'() {
    const failing = `await preview(key, scene, 1)
      await new Promise((done) => setTimeout(done, 4000))
      throw new Error('it broke off')`
    const fail = (text) => text.replace(/put\(key, scene\)\s+return factsOf\(scene\)/, failing)
    await changed('/viewer/worker.js', fail, async () => {
      await go('?scene=/scenes/scene.ply', width, height)
      await until('v.view')
      await enter()
      await until(`!v.hasAttribute('headset') && v.state === 'empty'`)
      await inside('test.run(1)')
      await until(`/it broke off/.test($('words').textContent)`)
    })
  },

  async 'by WebGL 2, and by WebGPU where there is: the same pixels'() {
    const counts = (text) => `const { transferToImageBitmap } = OffscreenCanvas.prototype
      self.bitmaps = 0
      OffscreenCanvas.prototype.transferToImageBitmap = function () {
        self.bitmaps++
        return transferToImageBitmap.call(this)
      }
      ${text}`
    for (const backend of process.env.WEBGPU ? ['webgl2', 'webgpu'] : ['webgl2'])
      await changed('/viewer/worker.js', counts, async () => {
        await open(backend)
        await enter()
        await settle()
        assert.equal(await inside('return v.backend'), backend)
        assert.equal(hash(await pixels()), native())
        assert.ok(await engineOf().evaluate(() => self.bitmaps > 2), 'the processor drew')
        await leave()
        if (process.env.WEBGPU) await seenThrough()
      })
  },

  async 'refused: words'() {
    await inside(`navigator.xr.requestSession = async () => { throw new Error('not now') }; $('headset').click()`)
    await until(`$('words').textContent === 'The headset: not now'`)
  },

  async 'without a headset no button; on a page that is not secure words'() {
    await page.removeScriptToEvaluateOnNewDocument(identifier)
    await open('wasm')
    assert.equal(await inside(`return $('headset').hidden`), true)
    await page.setUserAgent('Mozilla/5.0 (X11; Linux x86_64; Quest 3) OculusBrowser/35.0 Chrome/126.0')
    await page.goto(`${base.replace('127.0.0.1', 'far.test')}/viewer/index.html?scene=/scenes/scene.ply`)
    await still()
    faults.length = 0
    assert.equal(await inside('return isSecureContext'), false)
    await inside(`$('headset').click()`)
    await until(`/https/.test($('words').textContent)`)
  },
}

await run(tests)
process.exit()
