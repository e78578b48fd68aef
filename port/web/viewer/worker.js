// The scene, beside the page: it loads and draws while the page goes on.
import { load, png } from '../fixsplat.js'

const MOST = 2e9 // bytes of a file that a module of WebAssembly can hold and unpack
let scene

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

const words = {
  /** A File, or the address of one. */
  async open(name, source) {
    const file = typeof source === 'string' ? await download(name, source) : source
    if (file.size > MOST) throw tooLarge(name, file.size)
    tell('prepare')
    scene = await load(file, { progress: (done) => tell('prepare', done) })
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
