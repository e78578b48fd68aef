// The tests of walking, gamepads and the stick for the thumb, for page.mjs.
import assert from 'node:assert/strict'
import { writeFileSync } from 'node:fs'
import { hash, inside, moved, native, open, page, pause, scenes, shown, viewOf } from './chromium.mjs'

// A yard: a floor at y = 0, up is -y. A ramp and what it leads to at the right, a wall at the left, a hole in the middle.
const RAMP = { left: 1, right: 3, from: 1, slope: 0.3, top: 4 }
const WALL = { z: 3, right: -0.5, tall: 2 }
const HOLE = { x: [-0.3, 0.4], z: [0.4, 1.1], deep: 6 }
const rise = (x, z) =>
  x < RAMP.left || x > RAMP.right ? 0 : RAMP.slope * Math.max(0, Math.min(z, RAMP.top) - RAMP.from)

function yard() {
  const points = [] // position, then the scales' logarithms
  const [flat, thin] = [Math.log(0.05), Math.log(0.004)]
  const isHole = (x, z) => x > HOLE.x[0] && x < HOLE.x[1] && z > HOLE.z[0] && z < HOLE.z[1]
  for (let i = 0; i < 80; i++)
    for (let k = 0; k < 110; k++) {
      const [x, z] = [-4 + 0.1 * i, -3 + 0.1 * k]
      points.push([x, isHole(x, z) ? HOLE.deep : -rise(x, z), z, flat, thin, flat])
    }
  for (let x = -4; x < WALL.right; x += 0.1)
    for (let y = 0; y < WALL.tall; y += 0.1) points.push([x, -y, WALL.z, flat, flat, thin])
  const names = ['x', 'y', 'z', 'scale_0', 'scale_1', 'scale_2', 'f_dc_0', 'f_dc_1', 'f_dc_2', 'opacity',
    'rot_0', 'rot_1', 'rot_2', 'rot_3']
  const header = `ply\nformat binary_little_endian 1.0\nelement vertex ${points.length}\n` +
    names.map((name) => `property float ${name}\n`).join('') + 'end_header\n'
  const colours = (x, z) => [Math.sin(3 * x), Math.sin(3 * z), 0.2]
  const rows = points.flatMap((p) => [...p, ...colours(p[0], p[2]), 4, 1, 0, 0, 0])
  writeFileSync(`${scenes}/yard.ply`, Buffer.concat([Buffer.from(header), Buffer.from(new Float32Array(rows).buffer)]))
}

const numbersOf = async () => (await viewOf()).split(',').map(Number)
const YARD = (x, z, to = [x, 9]) => `?scene=/scenes/yard.ply&eye-height=1#view=${x},-1.2,${z},${to[0]},-1.2,${to[1]},0,-1,0,60`
const near = (a, b, most, words) => assert.ok(Math.abs(a - b) <= most, `${words}: ${a}, not ${b}`)

async function walk(...place) {
  await open(YARD(...place))
  await page.keyboard.press('3')
  await page.waitForFunction(() => document.querySelector('fixsplat-viewer').settings.mode === 'walk')
  await pause(700)
  await moved()
  await inside(`v.seen = []
    v.addEventListener('camera', ({ detail }) => v.seen.push(detail.camera.eye))
    v.addEventListener('frame', ({ detail }) => (v.parts ??= new Set()).add(detail.divisor))`)
}

/** Walks by a key until the eye is somewhere, or does not get on. */
async function hold(key, until) {
  await page.keyboard.down(key)
  for (let last = null; ; ) {
    await pause(250)
    const eye = (await numbersOf()).slice(0, 3)
    if (until?.(eye) || (last && Math.hypot(...eye.map((x, i) => x - last[i])) < 0.01)) break
    last = eye
  }
  await page.keyboard.up(key)
  await moved()
  return (await numbersOf()).slice(0, 3)
}

export const walking = {
  async 'walking: on the ground, up a ramp; whole pictures at rest'() {
    yard()
    await walk(2, -2)
    near((await numbersOf())[1], -1, 0.01, 'it lands')
    const [x, y, z] = await hold('w', ([, , z]) => z > 3.2)
    near(x, 2, 1e-6, 'straight on')
    near(-y - rise(x, z), 1, 0.02, 'at rest')
    const seen = await inside('return v.seen')
    assert.ok(seen.length > 10)
    for (const [x, y, z] of seen) near(-y - rise(x, z), 1, 0.08, `at ${z}`)
    assert.equal(await hash(), native('yard.ply', await viewOf(), '640x360'))
    assert.deepEqual((await shown()).size, [640, 360])
    assert.ok((await inside('return [...v.parts]')).some((divisor) => divisor > 1))
    const up = await hold('ArrowDown', ([, , z]) => z < 1.5)
    assert.ok(up[2] < 2)
    await inside('v.settings = { eyeHeight: 0.5 }')
    await pause(300)
    await moved()
    const low = await numbersOf()
    near(-low[1] - rise(low[0], low[2]), 0.5, 0.03, 'another height')
    await page.keyboard.press('r')
    await moved()
    await hold('w')
    const [ox, oy, oz] = await numbersOf()
    near(-oy - rise(ox, oz), 0.5, 0.03, 'it lands again')
  },

  async 'walking: a wall stops, and is walked along; a hole is gone over'() {
    await walk(-2, 1.5)
    const [, , z] = await hold('w')
    assert.ok(z > WALL.z - 0.45 && z < WALL.z - 0.1, `the wall is at ${WALL.z}, it stops at ${z}`)
    await walk(-2, 1.5, [-5, 4])
    const along = await hold('w', ([x]) => x < -3.4)
    assert.ok(along[0] < -3 && along[2] < WALL.z - 0.1, `along the wall to ${along}`)
    await walk(0.05, -0.8)
    const over = await hold('w', ([, , z]) => z > HOLE.z[1] + 0.3)
    assert.ok(over[2] > HOLE.z[1])
    for (const [, y] of await inside('return v.seen')) near(y, -1, 0.03, 'over the hole')
  },

  async 'walking: where no number is given, and by a double click'() {
    await open(YARD(2, -2).replace('&eye-height=1', ''))
    await page.keyboard.press('3')
    await pause(700)
    await moved()
    const height = -(await numbersOf())[1] // of the floor 0
    near(height, (HOLE.deep + WALL.tall) / 8, 0.05, 'an eighth of what is there')
    await page.mouse.click(320, 250, { count: 2 })
    await pause(800)
    await moved()
    const [x, y, z] = await numbersOf()
    assert.ok(z > -1.9)
    near(-y - rise(x, z), height, 0.03, 'as high there')
  },

  async 'a gamepad moves, looks and chooses; it is looked at while there is a reason to'() {
    await page.evaluateOnNewDocument(`{
      const pads = []
      window.looked = 0
      Object.defineProperty(navigator, 'getGamepads', { value: () => (window.looked++, pads) })
      window.pad = (axes, pressed = []) => {
        const buttons = Array.from({ length: 17 }, (_, i) => ({ value: pressed.includes(i) ? 1 : 0 }))
        pads[0] = axes && { connected: true, mapping: 'standard', axes, buttons }
      }
    }`)
    await open(YARD(2, -2))
    const push = async (axes, pressed, ms = 400) => {
      await inside('window.pad(...args)', axes, pressed ?? [])
      await pause(ms)
      await inside('window.pad([0, 0, 0, 0])')
      await moved()
      return numbersOf()
    }
    const start = await numbersOf()
    await inside(`window.pad([0, 0, 0, 0]); dispatchEvent(new Event('gamepadconnected'))`)
    await pause(300)
    assert.deepEqual(await push([0.1, -0.1, 0.05, 0]), start)
    await push([0, 0, 0, 0], [0])
    assert.equal(await inside('return v.settings.mode'), 'walk')
    await pause(700)
    await moved()
    const stood = await numbersOf()
    near(stood[1], -1, 0.01, 'it stands')
    const walked = await push([0, -1, 0, 0])
    assert.ok(walked[2] > stood[2] + 0.2)
    near(walked[0], 2, 1e-6, 'ahead')
    const turned = await push([0, 0, 1, 0])
    assert.deepEqual(turned.slice(0, 3), walked.slice(0, 3))
    assert.ok(turned[3] > walked[3] + 1, `to the right: ${walked}; ${turned}`)
    await push([0, 0, 0, 0], [0])
    assert.equal(await inside('return v.settings.mode'), 'fly')
    assert.ok((await push([0, 0, 0, 0], [5]))[1] < turned[1] - 0.05, 'up')
    const looks = () => inside('const before = window.looked; await new Promise((done) => setTimeout(done, 200)); return window.looked - before')
    assert.ok((await looks()) > 2)
    await inside(`v.style.position = 'absolute'; v.style.top = '5000px'`)
    await pause(200)
    assert.equal(await looks(), 0)
    await inside(`v.style.top = '0'`)
    await pause(200)
    assert.ok((await looks()) > 2)
    await inside('window.pad(null)')
    await pause(100)
    assert.equal(await looks(), 0)
  },

  async 'a stick for the thumb flies and walks, while another finger looks'() {
    await open(YARD(2, -2))
    const touch = await page.createCDPSession()
    const send = (type, ...list) =>
      touch.send('Input.dispatchTouchEvent', { type, touchPoints: list.map(([x, y, id]) => ({ x, y, id })) })
    const isThere = () => inside(`return !!$('stick')?.checkVisibility()`)
    await page.keyboard.press('3')
    await pause(700)
    await moved()
    assert.equal(await isThere(), false)
    await send('touchStart', [400, 100, 0])
    await send('touchEnd')
    await page.waitForFunction(() => document.querySelector('fixsplat-viewer').shadowRoot.getElementById('stick'))
    assert.equal(await isThere(), true)
    const [x, y] = await inside(`const { left, top, width } = $('stick').getBoundingClientRect()
      return [left + width / 2, top + width / 2]`)
    const start = await numbersOf()
    await send('touchStart', [x, y, 0])
    await send('touchMove', [x, y - 60, 0])
    await pause(400)
    const walked = await numbersOf()
    assert.ok(walked[2] > start[2] + 0.2 && Math.abs(walked[0] - start[0]) < 1e-6, `ahead to ${walked}`)
    await send('touchStart', [x, y - 60, 0], [400, 150, 1])
    await send('touchMove', [x, y - 60, 0], [440, 150, 1])
    await pause(100)
    await send('touchEnd')
    await moved()
    const turned = await numbersOf()
    assert.ok(turned[3] > walked[3] + 0.5, `to the right, as by a mouse: ${walked}; ${turned}`)
    await pause(200)
    assert.deepEqual(await numbersOf(), turned)
    // A marker on it is what a touch means.
    const at = `return v.shadowRoot.elementFromPoint(...args)`
    assert.equal(await inside(`${at}.id`, x, y), 'stick')
    await inside(`v.annotations = [{ position: (await v.pick(...args)).position, title: 'Here' }]`, x, y)
    await page.waitForFunction(() => document.querySelector('fixsplat-viewer').shadowRoot.querySelector('.marker'))
    await moved()
    assert.match(await inside(`${at}.className`, x, y), /marker/)
    await inside(`v.setAttribute('noui', '')`)
    assert.equal(await isThere(), false)
    await inside(`v.setAttribute('joystick', ''); await new Promise(requestAnimationFrame)`)
    assert.equal(await isThere(), true)
    await inside(`v.settings = { mode: 'orbit' }; await new Promise(requestAnimationFrame)`)
    assert.equal(await isThere(), false)
  },
}
