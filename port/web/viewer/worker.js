// The scene, beside the page: it loads and draws while the page goes on.
import { load, png, Screen } from '../fixsplat.js'

const MOST = 2e9 // bytes of a file that a module of WebAssembly can hold and unpack
let scene, how

const tell = (stage, done, bytes) => postMessage({ stage, done, bytes })
const tooLarge = (name, bytes) => new Error(`${name}: ${(bytes / 1e9).toFixed(1)} GB are more than a page can hold`)

async function answerOf(name, url) {
  const answer = await fetch(url).catch(() => {
    throw new Error(
      `${name}: cannot be reached. Is the address right, and does its server allow other pages to read it?`
    )
  })
  if (answer.status === 404) throw new Error(`${name}: there is no such file at this address`)
  if (!answer.ok) throw new Error(`${name}: the server answered ${answer.status} ${answer.statusText}`)
  return answer
}

async function download(name, url) {
  const answer = await answerOf(name, url)
  const total = answer.headers.get('content-encoding') ? 0 : Number(answer.headers.get('content-length'))
  const parts = []
  let bytes = 0
  if (total > MOST) throw tooLarge(name, total)
  const reader = answer.body.getReader()
  for (let part; !(part = await reader.read().catch(() => ({ cut: true }))).done; parts.push(part.value)) {
    if (part.cut) throw new Error(`${name}: the download broke off after ${bytes} bytes`)
    if ((bytes += part.value.length) > MOST) throw tooLarge(name, bytes)
    tell('download', total ? bytes / total : undefined, bytes)
  }
  return new File(parts, name)
}

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
    const file = typeof source === 'string' ? await download(name, source) : source
    if (file.size > MOST) throw tooLarge(name, file.size)
    tell('prepare')
    how = { progress: (done) => tell('prepare', done) }
    scene = await load(file, how)
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
