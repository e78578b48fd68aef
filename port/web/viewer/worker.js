// The scene, beside the page: it loads and draws while the page goes on.
import { load, png, Screen } from '../fixsplat.js'

const PREVIEW_MS = 1000 // at most, until the page has drawn what there is
const screens = {}
let scene, how
let drawn = () => {}

const factsOf = ({ name, count, low, high }) => ({ name, count, low, high })

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

async function draw(screen, camera, options) {
  try {
    screen.draw([{ scene }], camera, options)
    await screen.finish()
  } catch (error) {
    if (!screen.lost) throw error
  }
}

const words = {
  async open(source, threads, previews) {
    how = { threads }
    const progress = (progress) => postMessage(progress)
    const whole = await load(source, { ...how, progress, preview: previews ? preview : undefined })
    scene?.free()
    scene = whole
    return factsOf(scene)
  },

  async screen(id, canvas, backend) {
    screens[id] = await Screen.open(canvas, backend, how)
    canvas.addEventListener('webglcontextlost', () => postMessage({ stage: 'lost', id }))
  },

  /** On a screen; without one the pixels are the answer. */
  async draw(id, camera, options) {
    const start = performance.now()
    const screen = screens[id]
    const pixels = screen ? await draw(screen, camera, options) : scene.render(camera, options)
    onScreen(drawn)
    return { pixels, milliseconds: performance.now() - start, lost: screen?.lost }
  },

  packed: () => scene.packed,
  pick: (x, y, camera, options) => scene.pick(x, y, camera, options),

  png: (camera, options) => png(scene.render(camera, options), options.width, options.height),
}

self.onmessage = async ({ data: { id, word, args } }) => {
  try {
    const result = await words[word](...args)
    const bytes = result?.pixels ?? result
    postMessage({ id, result }, bytes?.buffer ? [bytes.buffer] : [])
  } catch (error) {
    postMessage({ id, error: error.message })
  }
}
