// The scene, beside the page: it loads and draws while the page goes on.
import { load, png, Screen } from '../fixsplat.js'

let scene, how

let eyes // what WebGL draws a headset's pictures on: { canvas, screen }

/** Pictures side by side, or null where that failed. */
async function bitmapOf(cameras, options, backend) {
  const { width, height } = options
  if (eyes?.screen.backend !== backend) {
    const canvas = new OffscreenCanvas(1, 1)
    eyes = { canvas, screen: await Screen.open(canvas, backend, how) }
  }
  const { canvas, screen } = eyes
  const whole = cameras.length * width
  if (canvas.width !== whole || canvas.height !== height) Object.assign(canvas, { width: whole, height })
  cameras.forEach((camera, i) => screen.draw([{ scene }], camera, { ...options, into: { x: i * width } }))
  await screen.finish()
  return canvas.transferToImageBitmap()
}

const words = {
  /** A File, or the address of one. */
  async open(name, source) {
    how = { progress: (progress) => postMessage(progress) }
    scene = await load(source, how)
    const { count, low, high } = scene
    return { name: scene.name, count, low, high }
  },

  render(camera, options) {
    const start = performance.now()
    const pixels = scene.render(camera, options)
    return { pixels, milliseconds: performance.now() - start }
  },

  /** What one or two eyes see: the pixels of each, or where WebGL draws a bitmap. */
  async eyes(cameras, options, backend) {
    const bitmap = backend !== 'wasm' && (await bitmapOf(cameras, options, backend).catch(() => null))
    if (bitmap) return { bitmap }
    return { pictures: cameras[1] ? scene.renderStereo(...cameras, options) : [scene.render(cameras[0], options)] }
  },

  pick: (x, y, camera, options) => scene.pick(x, y, camera, options),

  async png(camera, options) {
    return png(scene.render(camera, options), options.width, options.height)
  },
}

self.onmessage = async ({ data: { id, word, args } }) => {
  try {
    const result = await words[word](...args)
    const { pixels, pictures = [], bitmap } = result ?? {}
    const buffers = [pixels, ...pictures].filter(Boolean).map(({ buffer }) => buffer)
    postMessage({ id, result }, bitmap ? [bitmap] : buffers)
  } catch (error) {
    postMessage({ id, error: error.message })
  }
}
