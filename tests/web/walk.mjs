// Tests of walking in the viewer, of gamepads and of the on-screen joystick, for page.mjs.
import assert from 'node:assert/strict'
import { execFileSync } from 'node:child_process'
import { writeFileSync } from 'node:fs'
import { command, hash, inside, moved, native, open, page, pause, scenes, shown, viewOf, without } from './chromium.mjs'

// A generated scene to walk in, with the floor at y = 0 and up as -y. It has a ramp and a platform at the right, a wall
// at the left, and a hole between.
const RAMP = { left: 1, right: 3, from: 1, slope: 0.3, top: 4 }
const WALL = { z: 3, right: -0.5, tall: 2 }
const HOLE = { x: [-0.3, 0.4], z: [0.4, 1.1], deep: 6 }
const rise = (x, z) =>
  x < RAMP.left || x > RAMP.right ? 0 : RAMP.slope * Math.max(0, Math.min(z, RAMP.top) - RAMP.from)

// A wall across the whole yard that only the voxels of walled.ply have.
const UNSEEN = { z: 1.8 }

function yard(name, isWalled) {
  const points = []
  const [flat, thin] = [Math.log(0.05), Math.log(0.004)]
  const isHole = (x, z) => x > HOLE.x[0] && x < HOLE.x[1] && z > HOLE.z[0] && z < HOLE.z[1]
  for (let i = 0; i < 80; i++)
    for (let k = 0; k < 110; k++) {
      const [x, z] = [-4 + 0.1 * i, -3 + 0.1 * k]
      points.push([x, isHole(x, z) ? HOLE.deep : -rise(x, z), z, flat, thin, flat])
    }
  for (let x = -4; x < WALL.right; x += 0.1)
    for (let y = 0; y < WALL.tall; y += 0.1) points.push([x, -y, WALL.z, flat, flat, thin])
  for (let x = -4; isWalled && x < 4; x += 0.1)
    for (let y = 0; y < WALL.tall; y += 0.1) points.push([x, -y, UNSEEN.z, flat, flat, thin])
  const names = ['x', 'y', 'z', 'scale_0', 'scale_1', 'scale_2', 'f_dc_0', 'f_dc_1', 'f_dc_2', 'opacity',
    'rot_0', 'rot_1', 'rot_2', 'rot_3']
  const header = `ply\nformat binary_little_endian 1.0\nelement vertex ${points.length}\n` +
    names.map((name) => `property float ${name}\n`).join('') + 'end_header\n'
  const colours = (x, z) => [Math.sin(3 * x), Math.sin(3 * z), 0.2]
  const rows = points.flatMap((p) => [...p, ...colours(p[0], p[2]), 4, 1, 0, 0, 0])
  writeFileSync(`${scenes}/${name}`, Buffer.concat([Buffer.from(header), Buffer.from(new Float32Array(rows).buffer)]))
}

const start = [2, -1.2, 0.4]
const YARD = `?scene=/scenes/yard.ply&eye-height=1&background=%230e1116#view=${start},2,-1.2,9,0,-1,0,60`
const above = ([x, y, z]) => -y - rise(x, z)
const near = (a, b, most, words) => assert.ok(Math.abs(a - b) <= most, `${words}: ${a}, not ${b}`)
const eye = () => inside('return v.camera.eye')

async function until(is, words) {
  for (let i = 0; i < 300; i++) {
    if (await is()) return
    await pause(100)
  }
  assert.fail(words)
}

const stands = (height, words) => until(async () => Math.abs(above(await eye()) - height) < 0.03, words)

async function hold(key, isThere = () => false) {
  await page.keyboard.down(key)
  for (let [last, rests, i] = [await eye(), -5, 0]; rests < 4; i++) {
    assert.ok(i < 200, `${key}: it does not end`)
    await pause(150)
    const now = await eye()
    if (isThere(now)) break
    rests = Math.hypot(...now.map((x, i) => x - last[i])) < 1e-3 ? rests + 1 : Math.min(rests, 0)
    last = now
  }
  await page.keyboard.up(key)
  await moved()
  return eye()
}

async function from(x, z, [to, far]) {
  await inside(`v.camera = { eye: [args[0], -1.1, args[1]], look: [args[2], -1.1, args[3]], up: [0, -1, 0] }
    v.seen = []`, x, z, to, far)
}

async function rests() {
  for (;;) {
    const view = await viewOf()
    await moved()
    const drawn = await hash()
    if (view === (await viewOf())) return [view, drawn]
  }
}

const STUB = `{
  const pads = []
  window.looked = 0
  navigator.getGamepads = () => (window.looked++, pads)
  window.pad = (axes, pressed = []) => {
    const buttons = Array.from({ length: 17 }, (_, i) => ({ value: pressed.includes(i) ? 1 : 0 }))
    pads[0] = axes && { connected: true, mapping: 'standard', axes, buttons }
  }
}`

async function ground() {
  await page.keyboard.press('3')
  await stands(1, 'it comes down')
  await inside(`v.seen = []
    v.settings = { speed: 1 }
    v.addEventListener('camera', ({ detail }) => v.seen.push(detail.camera.eye))
    v.addEventListener('frame', () => (v.states ??= new Set()).add(v.state))`)
  const [x, , z] = await hold('w', ([, , z]) => z > 2)
  near(x, 2, 1e-6, 'straight on')
  near(above(await eye()), 1, 0.03, 'on the ramp')
  const seen = await inside('return v.seen')
  assert.ok(z > 2 && seen.length > 10)
  for (const place of seen) near(above(place), 1, 0.2, `at ${place}`)
  assert.ok(await inside(`return v.states.has('moving')`))
  const [view, drawn] = await rests()
  assert.equal(drawn, native('yard.ply', view, '400x260'))
  assert.deepEqual((await shown()).size, [400, 260])
  const [, , back] = await hold('ArrowDown', ([, , now]) => now < z - 0.2)
  assert.ok(back < z - 0.1)
}

async function walls() {
  await inside('v.settings = { speed: 2 }')
  await from(-2, 2.1, [-2, 9])
  const [, , z] = await hold('w')
  assert.ok(z > WALL.z - 0.45 && z < WALL.z - 0.1, `the wall is at ${WALL.z}, it stops at ${z}`)
  await inside('v.settings = { speed: 1 }')    // a slow machine overshoots less
  await from(-2, 2.5, [-4, 4])
  const along = await hold('w', ([x]) => x < -2.9)
  assert.ok(along[0] < -2.8 && along[2] < WALL.z - 0.1, `along the wall to ${along}`)
}

async function voxels() {
  yard('walled.ply', true)
  const walker = ['--voxel', '0.1', '--radius', '0.15', '--height', '0.9', '--seed=-2,-0.8,0']
  execFileSync(command, ['collide', `${scenes}/walled.ply`, '-o', `${scenes}/walled.voxel.json`, '--quiet', ...walker])
  await inside(`v.setAttribute('walls', '/scenes/walled.voxel.json')`)
  await from(-2, 0.2, [-2, 9])
  const [, , stopped] = await hold('w')
  assert.ok(stopped > 1.2 && stopped < UNSEEN.z - 0.1, `voxels at ${UNSEEN.z}, it stops at ${stopped}`)
  await inside(`v.removeAttribute('walls')`)
  await from(-2, 0.2, [-2, 9])
  const [, , z] = await hold('w', ([, , z]) => z > UNSEEN.z)
  assert.ok(z > UNSEEN.z, `without voxels, it stops at ${z}`)
}

async function holes() {
  await from(0.05, 0, [0.05, 9])
  const [, , z] = await hold('w', ([, , z]) => z > HOLE.z[1])
  assert.ok(z > HOLE.z[1])
  for (const [, y, z] of await inside('return v.seen')) if (z > 0.1) near(y, -1, 0.03, 'over the hole')
}

async function heights() {
  await inside('v.settings = { eyeHeight: 0.5 }')
  await stands(0.5, 'lower')
  await page.keyboard.press('r')
  await until(async () => (await eye())[1] < -3, 'the start')
  await moved()
  await hold('w', (place) => above(place) < 0.52)
  await stands(0.5, 'on the ground again')
  await inside(`v.settings = { eyeHeight: 0 }`)
  await stands((HOLE.deep + WALL.tall) / 8, 'an eighth of what there is')
  await from(-2, -2, [-2, 1])
  await page.mouse.click(200, 185, { count: 2 })
  await until(async () => (await eye())[2] > -1.9, 'it goes there')
  await stands((HOLE.deep + WALL.tall) / 8, 'as high there')
}

async function push(axes, pressed = []) {
  await inside('window.pad(...args)', axes, pressed)
  await pause(400)
  await inside('window.pad([0, 0, 0, 0])')
  await moved()
  return inside('return v.camera')
}

async function gamepad() {
  await inside('v.settings = { eyeHeight: 1 }')
  await from(2, -2, [2, 9])
  const first = await inside('return v.camera')
  await inside(`window.pad([0, 0, 0, 0])
    dispatchEvent(new Event('gamepadconnected'))`)
  await until(() => inside('return window.looked > 2'), 'it is looked at')
  assert.deepEqual(await push([0.1, -0.1, 0.05, 0]), first)
  await push([0, 0, 0, 0], [0])
  assert.equal(await inside('return v.settings.mode'), 'fly')
  assert.ok((await push([0, 0, 0, 0], [5])).eye[1] < first.eye[1] - 0.02, 'up')
  await push([0, 0, 0, 0], [0])
  assert.equal(await inside('return v.settings.mode'), 'walk')
  await stands(1, 'it stands')
  const stood = await inside('return v.camera')
  const walked = await push([0, -1, 0, 0])
  assert.ok(walked.eye[2] > stood.eye[2] + 0.1)
  near(walked.eye[0], 2, 1e-6, 'ahead')
  const turned = await push([0, 0, 1, 0])
  assert.deepEqual(turned.eye, walked.eye)
  assert.ok(turned.look[0] > walked.look[0] + 0.5, `to the right: ${turned.look}`)
}

async function polls() {
  const looks = () => inside(`await new Promise(requestAnimationFrame)
    const before = window.looked
    for (let i = 0; i < 5; i++) await new Promise(requestAnimationFrame)
    return window.looked - before`)
  const are = (is, words) => until(async () => (await looks()) > 0 === is, words)
  await inside(`Object.assign(v.style, { position: 'absolute', top: '5000px' })`)
  await are(false, 'not on the screen')
  await inside(`v.removeAttribute('style')`)
  await are(true, 'on the screen')
  await inside('window.pad(null)')
  await are(false, 'no gamepad')
}

async function stick() {
  const touch = await page.createCDPSession()
  const send = (type, ...list) =>
    touch.send('Input.dispatchTouchEvent', { type, touchPoints: list.map(([x, y, id]) => ({ x, y, id })) })
  const isThere = (is, words) => until(async () => (await inside(`return !!$('stick')?.checkVisibility()`)) === is, words)
  await from(2, -2, [2, 9])
  await isThere(false, 'no touchscreen')
  await send('touchStart', [300, 60, 0])
  await send('touchEnd')
  await isThere(true, 'a touchscreen')
  await moved()
  const [x, y] = await inside(`const { left, top, width } = $('stick').getBoundingClientRect()
    return [left + width / 2, top + width / 2]`)
  await send('touchStart', [x, y, 0])
  await send('touchMove', [x, y - 60, 0])
  await until(async () => (await eye())[2] > -1.9, 'ahead')
  near((await eye())[0], 2, 1e-6, 'straight')
  await send('touchStart', [x, y - 60, 0], [300, 60, 1])
  await send('touchMove', [x, y - 60, 0], [330, 60, 1])
  await until(async () => (await inside('return v.camera.look'))[0] > 2.5, 'another finger looks')
  await send('touchEnd')
  await moved()
  const last = await viewOf()
  await pause(200)
  assert.equal(await viewOf(), last)
  const at = () => inside(`const { id, className } = v.shadowRoot.elementFromPoint(...args); return id || className`, x, y)
  assert.equal(await at(), 'stick')
  await inside(`v.annotations = [{ position: (await v.pick(...args)).position, title: 'Here' }]`, x, y)
  await until(async () => /^marker/.test(await at()), 'a marker on it is what a touch means')
  await inside(`v.setAttribute('noui', '')`)
  await isThere(false, 'the picture alone')
  await inside(`v.setAttribute('joystick', '')`)
  await isThere(true, 'where it is asked for')
  await inside(`v.settings = { mode: 'orbit' }`)
  await isThere(false, 'no use for it')
}

async function two() {
  await open('?scene=/scenes/yard.ply&eye-height=1', 400, 260)
  const high = -(await eye())[1]
  await inside(`v.addEventListener('load', () => (v.settings = { mode: 'walk' }), { once: true })
    v.add('/scenes/yard.ply', { position: [6, 0, 0] })`)
  await until(async () => -(await eye())[1] < 2.5, `down from ${high}`)
  assert.ok(high > 3)
}

const OFTEN = [ground, walls, voxels, holes]
const SELDOM = [heights, gamepad, polls, stick, two] // slow tests, which run only with FXS_PROCESSORS=all

export const walking = {
  async 'walking: on the ground and up a ramp; walls and voxels stop, holes do not; with all, gamepads and a stick for the thumb'() {
    yard('yard.ply')
    await without(STUB, async () => {
      await open(YARD, 400, 260)
      for (const test of process.env.FXS_PROCESSORS === 'all' ? [...OFTEN, ...SELDOM] : OFTEN) await test()
    })
  },
}
