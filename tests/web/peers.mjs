// node peers.mjs PACKAGE SCENES MADE MODULES PICTURES [ROUNDS [SCENE...]]: compares fixsplat with other web viewers, in
// speed and pictures. The folder MADE has the generated scene landscape.ply.
import { execFileSync } from 'node:child_process'
import { createReadStream, existsSync, readdirSync, readFileSync } from 'node:fs'
import { createServer } from 'node:http'
import { createRequire } from 'node:module'
import { cpus } from 'node:os'
import { join, resolve } from 'node:path'
import { gzipSync } from 'node:zlib'
import { WEBGL } from './flags.mjs'

const [folder, scenes, makes, modules, pictures, rounds = '3', ...asked] = process.argv.slice(2)
const puppeteer = createRequire(resolve(modules, 'of'))('puppeteer-core')
const KINDS = { js: 'text/javascript', html: 'text/html', css: 'text/css', wasm: 'application/wasm', json: 'application/json' }
const [WIDTH, HEIGHT] = [1280, 720]
const STEP = 2
const LEAST_FRAMES = 8
const MOTION_MS = 12000
const QUIET_MS = 6000
const SAME = 1 // largest average difference between two pictures that count as equal, of 255

// Cameras of the compared scenes, in the axes of the scene files, where y points down.
const VIEWS = {
  snowmiku: {
    file: '/scenes/snowmiku/snowmiku.ply',
    eye: [-2.02394, 1.50942, -3.17181],
    look: [-1.26934, 1.0593, 0.73049],
    fov: 48.73,
  },
  guitar: { file: '/scenes/guitar/guitar.compressed.ply', eye: [5.5, -3.2, 0.2], look: [0.09, -2.1, 0.2], fov: 50 },
  landscape: { file: '/makes/landscape.ply', eye: [4.6, -1.9, -12.7], look: [0, -2.2, 0], fov: 52 },
}

function turned({ eye, look, fov }, degrees) {
  const [s, c] = [Math.sin, Math.cos].map((f) => f((degrees * Math.PI) / 180))
  const [x, y, z] = eye.map((e, i) => e - look[i])
  return { eye: [look[0] + c * x + s * z, look[1] + y, look[2] - s * x + c * z], look, fov }
}

/** Converts a camera to a settings file of supersplat-viewer, where y points up and the field of view is horizontal. */
function settingsOf(view) {
  const half = Math.tan((view.fov * Math.PI) / 360)
  const across = (360 / Math.PI) * Math.atan((half * WIDTH) / HEIGHT)
  const turn = ([x, y, z]) => [-x, -y, z]
  const frames = Array.from({ length: 180 }, (_, i) => turned(view, STEP * i))
  const off = { enabled: false }
  return {
    version: 2,
    tonemapping: 'none',
    highPrecisionRendering: false,
    background: { color: [0, 0, 0] },
    postEffectSettings: {
      sharpness: { ...off, amount: 0 },
      bloom: { ...off, intensity: 0.1, blurLevel: 2 },
      grading: { ...off, brightness: 1, contrast: 1, saturation: 1, tint: [1, 1, 1] },
      vignette: { ...off, intensity: 0.5, inner: 0.3, outer: 0.75, curvature: 1 },
      fringing: { ...off, intensity: 0.5 },
    },
    animTracks: [
      {
        name: 'orbit',
        duration: frames.length - 1,
        frameRate: 1,
        loopMode: 'none',
        interpolation: 'spline',
        smoothness: 0,
        keyframes: {
          times: frames.map((_, i) => i),
          values: {
            position: frames.flatMap(({ eye }) => turn(eye)),
            target: frames.flatMap(({ look }) => turn(look)),
            fov: frames.map(() => across),
          },
        },
      },
    ],
    cameras: [{ initial: { position: turn(view.eye), target: turn(view.look), fov: across } }],
    annotations: [],
    startMode: 'default',
  }
}

const sparkPage = (view, file) => `<!doctype html><style>body { margin: 0; background: #000; overflow: hidden }</style>
<script type="importmap">{ "imports": { "three": "/modules/three/build/three.module.js", "three/addons/": "/modules/three/examples/jsm/",
  "@sparkjsdev/spark": "/modules/@sparkjsdev/spark/dist/spark.module.min.js" } }</script>
<script type="module">
import * as THREE from 'three'
import { SparkRenderer, SplatMesh } from '@sparkjsdev/spark'
const scene = new THREE.Scene()
const camera = new THREE.PerspectiveCamera(${view.fov}, innerWidth / innerHeight, 0.01, 1000)
const renderer = new THREE.WebGLRenderer()
renderer.setSize(innerWidth, innerHeight)
document.body.append(renderer.domElement)
scene.add(new SparkRenderer({ renderer }))
const mesh = new SplatMesh({ url: '${file}' })
scene.add(mesh)
camera.up.set(0, -1, 0)
window.look = ({ eye, look }) => { camera.position.set(...eye); camera.lookAt(...look) }
look(${JSON.stringify(view)})
mesh.initialized.then(() => { peer.loaded = true })
renderer.setAnimationLoop(() => renderer.render(scene, camera))
</script>`

const supersplatPage = () =>
  readFileSync(join(modules, '@playcanvas/supersplat-viewer/public/index.html'), 'utf8').replace(
    'createViewer({ container',
    'window.firstFrame = () => { peer.loaded = true }; window.viewer = await createViewer({ container'
  )

const viewers = {
  fixsplat: {
    address: (file, view) =>
      `/fixsplat/viewer/index.html?noui&background=%23000000&scene=${file}` +
      `#view=${[...view.eye, ...view.look, 0, -1, 0, view.fov]}`,
    look: ({ eye, look, fov }) =>
      document.querySelector('fixsplat-viewer').setAttribute('view', [...eye, ...look, 0, -1, 0, fov].join()),
  },
  'supersplat-viewer': {
    address: (file) => `/supersplat/index.html?noui&noanim&content=${file}&settings=/settings.json`,
    look: (_, i) => window.viewer.seek(i),
  },
  Spark: { address: () => '/spark.html', look: (view) => window.look(view) },
}

const only = process.env.VIEWERS?.split(' ') ?? Object.keys(viewers)
const sent = new Set()
let now = {}
const made = {
  '/settings.json': () => JSON.stringify(settingsOf(now.view)),
  '/spark.html': () => sparkPage(now.view, now.file),
  '/supersplat/index.html': supersplatPage,
}
const places = {
  '/fixsplat/': folder,
  '/scenes/': scenes,
  '/makes/': makes,
  '/modules/': modules,
  '/supersplat/': join(modules, '@playcanvas/supersplat-viewer/public'),
}

function answer(request, response) {
  const path = decodeURIComponent(new URL(request.url, 'http://x').pathname)
  const place = Object.keys(places).find((p) => path.startsWith(p))
  const file = place && join(places[place], path.slice(place.length))
  response.setHeader('content-type', KINDS[path.split('.').pop()] ?? 'application/octet-stream')
  response.setHeader('cross-origin-opener-policy', 'same-origin')
  response.setHeader('cross-origin-embedder-policy', 'require-corp')
  response.setHeader('cache-control', 'no-store')
  if (path !== now.file && (made[path] || (file && existsSync(file)))) sent.add(path)
  if (made[path]) response.end(made[path]())
  else if (file && existsSync(file)) {
    response.setHeader('content-length', readFileSync(file).length)
    createReadStream(file).pipe(response)
  } else response.writeHead(404).end()
}

function downloaded() {
  let bytes = 0
  for (const path of sent) {
    const place = Object.keys(places).find((p) => path.startsWith(p))
    const body = made[path] ? made[path]() : readFileSync(join(places[place], path.slice(place.length)))
    if (path !== '/settings.json') bytes += gzipSync(body, { level: 9 }).length
  }
  return bytes
}

function processorTime(root) {
  const all = readdirSync('/proc').filter((name) => /^\d+$/.test(name))
  const fields = new Map()
  for (const pid of all)
    try {
      fields.set(pid, readFileSync(`/proc/${pid}/stat`, 'utf8').replace(/^.*\) /s, '').split(' '))
    } catch {}
  const isIn = (pid) => pid === root || (fields.has(pid) && isIn(fields.get(pid)[1]))
  const ticks = (f) => f.slice(11, 15).reduce((sum, n) => sum + Number(n), 0)
  return [...fields].reduce((sum, [pid, f]) => sum + (isIn(pid) ? ticks(f) / 100 : 0), 0)
}

/** Records the frames of a viewer's page. To wait for the end of a WebGL frame, reads a pixel of it back. */
function watch(width, height) {
  const peer = (window.peer = { frames: [], small: true, loaded: false, after: null, size: [] })
  const frame = (at, small) => {
    peer.frames.push({ at, small })
    if (small) drawn()
    peer.after?.()
  }
  const drawnOn = new Set()
  for (const Context of [WebGLRenderingContext, WebGL2RenderingContext])
    for (const name of Object.getOwnPropertyNames(Context.prototype).filter((n) => /^(draw[AE]|blitF)/.test(n))) {
      const draw = Context.prototype[name]
      Context.prototype[name] = function (...args) {
        if (this.canvas.isConnected && !this.bound) drawnOn.add(this)
        return draw.apply(this, args)
      }
    }
  for (const Context of [WebGLRenderingContext, WebGL2RenderingContext]) {
    const bind = Context.prototype.bindFramebuffer
    Context.prototype.bindFramebuffer = function (target, buffer) {
      if (target !== this.READ_FRAMEBUFFER) this.bound = buffer
      if (target !== this.DRAW_FRAMEBUFFER) this.read = buffer
      bind.call(this, target, buffer)
    }
    Context.prototype.finished = function (whole) {
      const { read, canvas } = this
      const target = this.READ_FRAMEBUFFER ?? this.FRAMEBUFFER
      const pixels = new Uint8Array(whole ? 4 * canvas.width * canvas.height : 4)
      bind.call(this, target, null)
      this.readPixels(0, 0, whole ? canvas.width : 1, whole ? canvas.height : 1, this.RGBA, this.UNSIGNED_BYTE, pixels)
      bind.call(this, target, read ?? null)
      peer.size = [canvas.width, canvas.height]
      return pixels
    }
  }
  const smaller = (pixels, w, h) => {
    const out = []
    for (let y = 4; y < h; y += 8) for (let x = 4; x < w; x += 8) out.push(...pixels.subarray(4 * (y * w + x)).slice(0, 3))
    return out
  }
  const request = window.requestAnimationFrame
  window.requestAnimationFrame = (callback) =>
    request.call(window, (time) => {
      drawnOn.clear()
      callback(time)
      for (const gl of drawnOn) {
        gl.finished(false)
        const at = performance.now()
        frame(at, peer.small && smaller(gl.finished(true), gl.canvas.width, gl.canvas.height))
      }
    })
  const canvasOf = (viewer) => [...viewer.shadowRoot.querySelectorAll('canvas')].find((c) => c.width > 1 && !c.hidden)
  const copied = (viewer) => {
    const copy = new OffscreenCanvas(width / 8, height / 8).getContext('2d')
    copy.imageSmoothingEnabled = false
    copy.drawImage(canvasOf(viewer), 0, 0, width / 8, height / 8)
    return [...copy.getImageData(0, 0, width / 8, height / 8).data].filter((_, i) => i % 4 < 3)
  }
  addEventListener('DOMContentLoaded', () => {
    const viewer = document.querySelector('fixsplat-viewer')
    viewer?.addEventListener('frame', ({ detail }) => {
      if (!(detail.width > peer.size[0])) peer.size = [detail.width, detail.height]
      const at = performance.now()
      if (!peer.small) return frame(at)
      request.call(window, () => request.call(window, () => frame(at, copied(viewer))))
    })
    if (viewer) setInterval(() => (peer.loaded ||= viewer.state === 'still'), 100)
  })
}

async function settled(page) {
  await page.waitForFunction(() => window.peer?.loaded, { timeout: 120000, polling: 200 })
  await page.waitForFunction(
    (quiet, same) => {
      const last = peer.frames.slice(-3)
      if (last.length && performance.now() - last.at(-1).at > quiet) return true
      const far = (a, b) => a.reduce((sum, x, i) => sum + Math.abs(x - b[i]), 0) / a.length
      return last.length === 3 && last[0].at > (peer.loadedAt ??= performance.now()) &&
        far(last[0].small, last[2].small) < same / 8
    },
    { timeout: 300000, polling: 250 },
    QUIET_MS,
    SAME
  )
}

const firstPicture = (page) =>
  page.evaluate((same) => {
    const last = peer.frames.at(-1).small
    const far = (a) => a.reduce((sum, x, i) => sum + Math.abs(x - last[i]), 0) / a.length
    let i = peer.frames.length - 1
    while (i > 0 && far(peer.frames[i - 1].small) < same) i--
    return { i, at: peer.frames[i].at }
  }, SAME)

async function motion(page, look, view) {
  const path = Array.from({ length: 180 }, (_, i) => turned(view, STEP * i))
  await page.evaluate(
    `{ const look = ${look}, path = ${JSON.stringify(path)}; let i = 0;
       peer.small = false; peer.frames = []; peer.size = []; peer.after = () => { i++; look(path[i % 180], i % 180) }; peer.after() }`
  )
  await page.waitForFunction(
    (least, ms) => {
      const { frames } = peer
      const taken = frames.length ? frames.at(-1).at - frames[0].at : 0
      return (frames.length > least && taken > ms) || (frames.length > 3 && taken > 5 * ms)
    },
    { timeout: 300000, polling: 250 },
    LEAST_FRAMES,
    MOTION_MS
  )
  const { at, size } = await page.evaluate(() => {
    peer.after = null
    return { at: peer.frames.map((f) => f.at), size: peer.size }
  })
  if (size.join('x') !== `${WIDTH}x${HEIGHT}`) throw new Error(`frames of ${size.join('x')}, not ${WIDTH}x${HEIGHT}`)
  return at.slice(1).map((t, i) => t - at[i])
}

const median = (list) => [...list].sort((a, b) => a - b)[list.length >> 1]

async function measure(base, name, scene, round) {
  const { address, look } = viewers[name]
  const { file, ...view } = VIEWS[scene]
  now = { view, file }
  sent.clear()
  const browser = await puppeteer.launch({
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
    args: ['--no-sandbox', ...WEBGL],
    protocolTimeout: 600000,
  })
  try {
    const processors = () => processorTime(String(browser.process().pid))
    const page = await browser.newPage()
    const busy = []
    const before = processors()
    await page.exposeFunction('drawn', () => busy.push(processors() - before))
    page.on('pageerror', (error) => console.error(`${name}: ${error.message}`))
    await page.setViewport({ width: WIDTH, height: HEIGHT })
    await page.evaluateOnNewDocument(watch, WIDTH, HEIGHT)
    await page.goto(base + address(file, view), { timeout: 300000 })
    await settled(page)
    const { i, at: first } = await firstPicture(page)
    const bytes = downloaded()
    await page.screenshot({ path: join(pictures, `${scene}-${name}.png`) })
    const start = processors()
    const times = await motion(page, look.toString(), view)
    const busyFrame = (1000 * (processors() - start)) / (times.length + 1)
    const result = { name, scene, round, first, busyFirst: busy[i], frame: median(times), busyFrame, frames: times.length, bytes }
    console.error(JSON.stringify({ ...result, times: times.map(Math.round) }))
    return result
  } finally {
    await browser.close()
  }
}

function table(results) {
  const rows = []
  for (const scene of new Set(results.map((r) => r.scene))) {
    const of = (name, key) => median(results.filter((r) => r.scene === scene && r.name === name).map((r) => r[key]))
    for (const name of only) {
      const ratio = (key) => (of(name, key) / of(only[0], key)).toFixed(1)
      rows.push(
        `| ${scene} | ${name} | ${Math.round(of(name, 'bytes') / 1000)} KB | ${(of(name, 'first') / 1000).toFixed(1)} s | ` +
          `${of(name, 'busyFirst').toFixed(1)} s | ${of(name, 'frame').toFixed(0)} ms | ${ratio('frame')} | ` +
          `${of(name, 'busyFrame').toFixed(0)} ms | ${ratio('busyFrame')} |`
      )
    }
  }
  return [
    '| scene | viewer | download | first picture | processors | a frame | times ours | processors | times ours |',
    '|---|---|---|---|---|---|---|---|---|',
    ...rows,
  ]
}

const server = createServer(answer).listen(0, '127.0.0.1')
await new Promise((done) => server.once('listening', done))
const base = `http://127.0.0.1:${server.address().port}`
const results = []
for (const scene of asked.length ? asked : Object.keys(VIEWS))
  for (let round = 0; round < Number(rounds); round++)
    for (const name of only) results.push(await measure(base, name, scene, round))
server.close()
const version = (name) => JSON.parse(readFileSync(join(modules, name, 'package.json'), 'utf8')).version
console.log(table(results).join('\n'))
console.log(
  `\n${cpus()[0].model}, ${cpus().length} processors, ${execFileSync(process.env.CHROMIUM ?? '/usr/bin/chromium', ['--version'], {
    encoding: 'utf8',
    stdio: ['ignore', 'pipe', 'ignore'],
  }).trim()}; commit ${execFileSync('git', ['rev-parse', '--short', 'HEAD'], { encoding: 'utf8' }).trim()}; supersplat-viewer ` +
    `${version('@playcanvas/supersplat-viewer')}, Spark ${version('@sparkjsdev/spark')} with three ${version('three')}; ` +
    `medians of ${rounds} rounds in turns`
)
