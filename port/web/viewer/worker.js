// The scene, beside the page: it loads and draws while the page goes on.
import { load, png } from '../fixsplat.js'

let scene

const words = {
  /** A File, or the address of one. */
  async open(name, source) {
    scene = await load(source, { progress: (progress) => postMessage(progress) })
    const { count, low, high } = scene
    return { name: scene.name, count, low, high }
  },

  render(camera, options) {
    const start = performance.now()
    const pixels = scene.render(camera, options)
    return { pixels, milliseconds: performance.now() - start }
  },

  pick: (x, y, camera, options) => scene.pick(x, y, camera, options),

  async png(camera, options) {
    return png(scene.render(camera, options), options.width, options.height)
  },
}

self.onmessage = async ({ data: { id, word, args } }) => {
  try {
    const result = await words[word](...args)
    postMessage({ id, result }, result?.pixels ? [result.pixels.buffer] : [])
  } catch (error) {
    postMessage({ id, error: error.message })
  }
}
