// The worker of a scene. It loads and draws the scene while the page goes on responding.
import { load, png, Screen } from '../fixsplat.js'

const PREVIEW_MS = 1000 // at most, until the page has drawn what there is
const AHEAD_MS = 600 // how far a camera in motion is followed, for parts that are to come
const STOPPED_MS = 300 // between two pictures: the camera did not move
const NO_DEPTH = 0xffffffff
const UNIT = 65536 // depths of a scene unit
const screens = {}
let scene, how
let drawn = () => {}

const factsOf = ({ name, count, levels, paged, low, high, first, start }) =>
  ({ name, count, levels, paged, low, high, first, start })

/** What has come of a scene so far: loading goes on when it was drawn. */
function preview(part) {
  scene?.free()
  scene = part
  postMessage({ stage: 'preview', scene: factsOf(part) })
  return new Promise((done) => {
    drawn = done
    setTimeout(done, PREVIEW_MS)
  })
}

/** Calls when the browser has taken what was drawn: not while a worker is busy. */
function onScreen(call) {
  if (globalThis.requestAnimationFrame) requestAnimationFrame(() => setTimeout(call))
  else call()
}

/** What was drawn, with the pixels where there is no screen; null where the screen has failed. */
async function draw(id, camera, options) {
  const screen = screens[id]
  if (!screen) {
    const { backdrop } = options
    const { colour, drawn, missing } = scene.render(camera, { ...options, targets: { colour: true, backdrop } })
    return { pixels: colour, drawn, missing }
  }
  let facts = null
  try {
    facts = screen.draw([{ scene }], camera, options)
    await screen.finish()
    return facts
  } catch (error) {
    if (facts) postMessage({ stage: 'lost', id })
    else if (!screen.lost) throw error
    return null
  }
}

/** The options of a frame, with what lies behind the scene where that is a picture. */
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

let last // the camera of the last picture, and when that was

/** Has fetched what the camera is to see soon, where it goes on as it did. */
function foresee(camera, options) {
  if (!scene.paged || scene.failure) return
  const now = performance.now()
  const before = last
  last = { position: camera.position, now }
  const moved = before && camera.position?.some((x, i) => x !== before.position?.[i])
  if (!moved || now - before.now > STOPPED_MS) return
  const far = AHEAD_MS / (now - before.now)
  const position = camera.position.map((x, i) => x + far * (x - before.position[i]))
  try {
    scene.foresee({ ...camera, position }, options)
  } catch {} // a place where no camera can be
}

let eyes // what WebGL or WebGPU draws a headset's pictures on: { canvas, screen }

/** Pictures side by side, or null where that failed. */
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
  for (let i = 0; i < cameras.length; i++) {
    screen.draw([{ scene }], cameras[i], { ...options, into: { x: i * width } })
    if (!gl || i === cameras.length - 1) await screen.finish()
  }
  return canvas.transferToImageBitmap()
}

const words = {
  async open(source, threads, previews) {
    how = { threads }
    const progress = (progress) => postMessage(progress)
    const changed = (error) => postMessage({ stage: 'changed', words: error?.message })
    const whole = await load(source, { ...how, progress, paging: { changed }, preview: previews ? preview : undefined })
    scene?.free()
    scene = whole
    return factsOf(scene)
  },

  async screen(id, canvas, backend) {
    if (backend === 'webgpu' && scene.paged) throw new Error('WebGPU draws no scene in parts')
    screens[id] = await Screen.open(canvas, backend, how)
    const lost = () => postMessage({ stage: 'lost', id })
    canvas.addEventListener('webglcontextlost', lost)
    screens[id].device?.lost.then(lost)
  },

  close(id) {
    screens[id].free()
    delete screens[id]
  },

  /** On a screen; without one the pixels are the answer. */
  async draw(id, camera, options) {
    const start = performance.now()
    const isRough = screens[id]?.backend === 'webgl2-quads'
    const facts = await draw(id, camera, await withSky(isRough ? { ...options, sky: null } : options, camera))
    foresee(camera, options)
    onScreen(drawn)
    return { ...facts, milliseconds: performance.now() - start, lost: !facts }
  },

  /** What one or two eyes see, each as alone: the pixels of each, or where the graphics card draws a bitmap. */
  async eyes(cameras, options, backend) {
    const bitmap = backend !== 'wasm' && (await bitmapOf(cameras, options, backend).catch(() => null))
    if (bitmap) return { bitmap }
    if (!cameras[1]) return { pictures: [scene.render(cameras[0], options)] }
    return { pictures: scene.renderStereo(...cameras, { ...options, exact: true }) }
  },

  packed: () => scene.packed,
  pick: (x, y, camera, options) => scene.pick(x, y, camera, options),

  async png(camera, options) {
    const { pixels } = await draw(0, camera, await withSky(options, camera))
    return png(pixels, options.width, options.height)
  },

  /** How far away what is seen at pixels of a small picture is, along the axis of view; Infinity where nothing is. The
      farthest of nine neighbours, as a marker lies on what it marks. */
  depths(pixels, camera, options) {
    const { width, height } = options
    const { depth } = scene.render(camera, { ...options, targets: { depth: true } })
    const at = (x, y) => depth[width * Math.min(Math.max(y, 0), height - 1) + Math.min(Math.max(x, 0), width - 1)]
    const around = (x, y) => [-1, 0, 1].flatMap((j) => [-1, 0, 1].map((i) => at(x + i, y + j)))
    return pixels.map(([x, y]) => Math.max(...around(x, y))).map((code) => (code === NO_DEPTH ? Infinity : code / UNIT))
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
