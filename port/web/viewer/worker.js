// The worker of a viewer, which loads and draws the scenes. The page (engine.js) sends requests { id, word, args }; the
// table `words` has the function of each word. Every request gets an answer { id, result } or { id, error }. Messages
// with a `stage` need no request.
import { edit, firstView, foresee, load, Pace, pick, png, render, renderStereo, Screen, setAssets } from 'fixsplat'
import { Sizes } from './pace.js'

const SEEN = 40000 // smallest number of Gaussians in an early preview
const SEEN_SHARE = 1 / 3 // downloaded share of the file after which a preview may have fewer than SEEN Gaussians
const PREVIEW_MS = 1000 // longest wait in milliseconds for the page to draw a preview
const AHEAD_MS = 600 // milliseconds of camera motion to extrapolate for prefetching parts of a scene
const STOPPED_MS = 300 // milliseconds between two pictures after which the camera counts as stopped
const NO_DEPTH = 0xffffffff
const UNIT = 65536 // depth value of one scene unit: depths have 16 fraction bits
const STRIP = 1 << 22 // pixels of a strip of a saved picture
const screens = {}
const scenes = new Map()
const editors = new Map()
let placed = []
let how
let drawn = () => {}

const isThere = ({ key }) => scenes.has(key)
const objects = () => placed.filter(isThere).map(({ key, place }) => ({ scene: scenes.get(key), ...place }))

/** Moves a point of a scene to its place in the world. A unit quaternion (w, q) rotates v to v + 2 w (q x v) + 2 q x (q
    x v). */
function moved(v, { translation = [0, 0, 0], rotation = [1, 0, 0, 0], scale = 1 }) {
  const [w, ...q] = rotation.map((x) => x / Math.hypot(...rotation))
  const cross = (a, b) => [1, 2, 0].map((j, i) => a[j] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[j])
  const once = cross(q, v)
  const twice = cross(q, once)
  return v.map((x, i) => translation[i] + scale * (x + 2 * (w * once[i] + twice[i])))
}

const corners = (low, high) =>
  [0, 1, 2, 3, 4, 5, 6, 7].map((i) => low.map((x, axis) => (i & (1 << axis) ? high : low)[axis]))

function boxOf(list) {
  const points = list.flatMap(({ scene, ...place }) => corners(scene.low, scene.high).map((v) => moved(v, place)))
  const [low, high] = [Math.min, Math.max].map((end) => [0, 1, 2].map((axis) => end(...points.map((v) => v[axis]))))
  return { low, high }
}

let seen = {}

function firstOf(list) {
  const of = placed.filter(isThere).map(({ key }) => key).join()
  if (seen.of !== of || seen.last !== list.at(-1).scene) seen = { of, last: list.at(-1).scene, first: firstView(list) }
  const [{ scene, ...place }] = list
  return { first: seen.first, start: Object.keys(place).length ? null : scene.start }
}

/** Returns the motion of the scene with the longest duration; null if all scenes are still. */
function motionOf(all) {
  const { duration, rate, loops } = all.reduce((longest, scene) => (scene.duration > longest.duration ? scene : longest))
  return duration ? { duration, rate, loops } : null
}

function whole() {
  const list = objects()
  if (!list.length) return null
  const all = list.map(({ scene }) => scene)
  const has = (name) => all.some((scene) => scene[name])
  const count = all.reduce((sum, scene) => sum + scene.count, 0)
  const facts = { count, levels: has('levels'), paged: has('paged'), moving: motionOf(all) }
  return { ...facts, ...boxOf(list), ...firstOf(list) }
}

const factsOf = ({ name, count, low, high, sound }) => ({ name, count, low, high, sound, whole: whole() })

function drop(key) {
  editors.get(key)?.then((editor) => editor.free())
  editors.delete(key)
  scenes.get(key)?.free()
}

function put(key, scene) {
  drop(key)
  scenes.set(key, scene)
}

/** Sends a preview of a loading scene to the page. Loading waits until the page has drawn the preview. A preview of few
    Gaussians is skipped. */
function preview(key, part, share) {
  if (part.count < SEEN && share < SEEN_SHARE) return part.free()
  put(key, part)
  postMessage({ stage: 'preview', key, scene: factsOf(part) })
  return new Promise((done) => {
    drawn = done
    setTimeout(done, PREVIEW_MS)
  })
}

function onScreen(call) {
  if (globalThis.requestAnimationFrame) requestAnimationFrame(() => setTimeout(call))
  else call()
}

/** Draws a picture on the Screen with the number `id`. Returns the pixels if there is no Screen, or null if the Screen
    has failed. */
async function draw(id, camera, options) {
  const screen = screens[id]
  if (!screen) {
    const { backdrop } = options
    const { colour, drawn, missing } = render(objects(), camera, { ...options, targets: { colour: true, backdrop } })
    return { pixels: colour, drawn, missing }
  }
  let facts = null
  try {
    facts = screen.draw(objects(), camera, options)
    await screen.finish()
    return facts
  } catch (error) {
    if (facts) postMessage({ stage: 'lost', id })
    else if (!screen.lost) throw error
    return null
  }
}

/** Renders a picture in strips, so that its size is not limited by the memory of the WebAssembly module. */
async function* strips(camera, { backdrop, ...options }) {
  const { width, height } = options
  const most = Math.ceil(STRIP / width)
  for (let first = 0; first < height; first += most) {
    const rows = [first, Math.min(most, height - first)]
    const [from, to] = [first, first + rows[1]].map((row) => 4 * width * row)
    const targets = { colour: true, backdrop: backdrop?.subarray(from, to) }
    yield render(objects(), camera, { ...options, rows, targets }).colour
  }
}

async function withSky({ sky, ...options }, camera) {
  if (!sky) return options
  try {
    const { backdropOf } = await import('./sky.js')
    return { ...options, backdrop: await backdropOf(sky, camera, options) }
  } catch (error) {
    postMessage({ stage: 'noSky', url: sky.url, words: error.message })
    return options
  }
}

let last

function lookAhead(camera, options) {
  const list = objects()
  if (!list.some(({ scene }) => scene.paged && !scene.failure)) return
  const now = performance.now()
  const before = last
  last = { position: camera.position, now }
  const moved = before && camera.position?.some((x, i) => x !== before.position?.[i])
  if (!moved || now - before.now > STOPPED_MS) return
  const far = AHEAD_MS / (now - before.now)
  const position = camera.position.map((x, i) => x + far * (x - before.position[i]))
  try {
    foresee(list, { ...camera, position }, options)
  } catch {}
}

/** Requests the parts of streamed moving scenes that are seen within the next `ahead` seconds. */
function prefetch({ time = 0, ahead }) {
  if (!ahead) return
  for (const { scene, time: own = 0 } of objects())
    if (scene.paged && !scene.failure) scene.prefetch(time + own, time + own + ahead)
}

let eyes

async function bitmapOf(cameras, options, backend) {
  const { width, height } = options
  if (eyes?.screen.backend !== backend) {
    eyes?.screen.free()
    const canvas = new OffscreenCanvas(1, 1)
    eyes = { canvas, screen: await Screen.open(canvas, backend, how) }
  }
  const { canvas, screen } = eyes
  const whole = cameras.length * width
  if (canvas.width !== whole || canvas.height !== height) Object.assign(canvas, { width: whole, height })
  const { gl } = screen
  if (gl && (gl.drawingBufferWidth !== whole || gl.drawingBufferHeight !== height)) return null
  const parts = gl ? cameras.map((camera, i) => [camera, { ...options, into: { x: i * width } }]) : [[cameras, options]]
  for (const part of parts) screen.draw(objects(), ...part)
  await screen.finish()
  return canvas.transferToImageBitmap()
}

let sizes

async function scaleAfter(moves, milliseconds) {
  sizes ??= new Sizes(await Pace.open(how))
  return sizes.take(moves, milliseconds)
}

const depthOf = (camera, options) =>
  render(objects(), camera, { ...options, fetch: false, targets: { depth: true } }).depth
const unitsOf = (code) => (code === NO_DEPTH ? Infinity : code / UNIT)

const words = {
  assets: setAssets,

  async open(key, source, place, { threads, previews }) {
    how = { threads }
    let share = 0
    const progress = (progress) => {
      share = progress.stage === 'download' ? (progress.done ?? 0) : 1
      postMessage({ ...progress, key })
    }
    const changed = (error) => postMessage({ stage: 'changed', words: error?.message })
    if (!placed.length) placed = [{ key, place }]
    const shown = previews ? (part) => preview(key, part, share) : undefined
    const scene = await load(source, { ...how, progress, paging: { changed }, preview: shown })
    put(key, scene)
    return factsOf(scene)
  },

  place(list) {
    placed = list
    return whole()
  },

  free(key) {
    drop(key)
    scenes.delete(key)
  },

  async screen(id, canvas, backend) {
    screens[id] = await Screen.open(canvas, backend, how)
    const lost = () => postMessage({ stage: 'lost', id })
    canvas.addEventListener('webglcontextlost', lost)
    screens[id].device?.lost.then(lost)
  },

  close(id) {
    screens[id].free()
    delete screens[id]
  },

  async draw(id, camera, options, moves) {
    const start = performance.now()
    const facts = await draw(id, camera, await withSky(options, camera))
    lookAhead(camera, options)
    prefetch(options)
    onScreen(drawn)
    const milliseconds = performance.now() - start
    const isTimed = facts && moves !== undefined
    const scale = isTimed ? await scaleAfter(moves, screens[id]?.milliseconds ?? milliseconds) : undefined
    return { ...facts, milliseconds, scale, lost: !facts }
  },

  async eyes(cameras, options, backend) {
    prefetch(options)
    const bitmap = backend !== 'wasm' && (await bitmapOf(cameras, options, backend).catch(() => null))
    if (bitmap) return { bitmap }
    if (!cameras[1]) return { pictures: [render(objects(), cameras[0], options)] }
    return { pictures: renderStereo(objects(), ...cameras, options) }
  },

  packed: async (key) => (await editors.get(key))?.write() ?? scenes.get(key).packed,

  /** Calls a method of a scene's Editor, or returns a property of it. */
  async edit(key, name, ...args) {
    if (!editors.has(key)) editors.set(key, edit(scenes.get(key)))
    const editor = await editors.get(key)
    const result = typeof editor[name] === 'function' ? editor[name](...args) : editor[name]
    if (name === 'act' || name === 'go') for (const screen of Object.values(screens)) screen.forget(editor.scene)
    return result
  },

  pick(x, y, camera, options) {
    const found = pick(x, y, objects(), camera, options)
    return found && { ...found, key: placed.filter(isThere)[found.object].key }
  },

  async png(camera, options) {
    const { width, height } = options
    for (const { scene } of objects()) if (scene.paged && !scene.failure) await scene.complete(camera, options)
    return png(strips(camera, await withSky(options, camera)), width, height)
  },

  heights: (camera, options) => Float32Array.from(depthOf(camera, options), unitsOf),

  /** Returns the depths at pixels in scene units, to test whether the scene hides the markers of annotations. The
      farthest depth of 3 x 3 pixels counts, since a marker lies on a surface. */
  depths(pixels, camera, options) {
    const { width, height } = options
    const depth = depthOf(camera, options)
    const at = (x, y) => depth[width * Math.min(Math.max(y, 0), height - 1) + Math.min(Math.max(x, 0), width - 1)]
    const around = (x, y) => [-1, 0, 1].flatMap((j) => [-1, 0, 1].map((i) => at(x + i, y + j)))
    return pixels.map(([x, y]) => unitsOf(Math.max(...around(x, y))))
  },
}

self.onmessage = async ({ data: { id, word, args } }) => {
  try {
    const result = await words[word](...args)
    const { pixels = result, pictures = [pixels], bitmap } = result ?? {}
    const buffers = pictures.map((bytes) => bytes?.buffer).filter(Boolean)
    postMessage({ id, result }, bitmap ? [bitmap] : buffers)
  } catch (error) {
    postMessage({ id, error: error.message })
  }
}
