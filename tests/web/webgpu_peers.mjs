// node webgpu_peers.mjs PACKAGE SCENES MODULES [ROUNDS [SCENE [SIZE [VIEWER...]]]]: frames by WebGPU of this package,
// of the engine of PlayCanvas and of three.js's GaussianSplat, of a scene (guitar) at a size (1280x720), while the
// camera goes around. MODULES: a node_modules with playcanvas, three and puppeteer-core. Each in a fresh browser, in
// turns. FXS_WEBGPU_FLAGS: of Chromium, in place of SwiftShader's. FRAMES: of which the median is taken (7).
import { createReadStream, existsSync, readFileSync } from 'node:fs'
import { createServer } from 'node:http'
import { createRequire } from 'node:module'
import { join, resolve } from 'node:path'
import { WEBGPU } from './flags.mjs'

const [folder, scenes, modules, rounds = '3', scene = 'guitar', size = '1280x720', ...asked] = process.argv.slice(2)
const puppeteer = createRequire(resolve(modules, 'of'))('puppeteer-core')
const KINDS = { js: 'text/javascript', mjs: 'text/javascript', wasm: 'application/wasm', html: 'text/html' }
const MAP = { three: '/modules/three/build/three.webgpu.js', 'three/webgpu': '/modules/three/build/three.webgpu.js',
  'three/tsl': '/modules/three/build/three.tsl.js', 'three/addons/': '/modules/three/examples/jsm/',
  playcanvas: '/modules/playcanvas/build/playcanvas.min.mjs' }
const FRAMES = Number(process.env.FRAMES ?? 7) // after two that are not counted
const [width, height] = size.split('x').map(Number)

// y up. snowmiku: its first view.
const VIEWS = {
  guitar: { eye: [5.5, 3.2, -0.2], look: [0.09, 2.1, -0.2], fov: 50 },
  snowmiku: { eye: [-2.02394, -1.50942, 3.17181], look: [-1.26934, -1.0593, -0.73049], fov: 48.73 },
}

// Each opens the scene and returns a function that draws from an eye, y up, the scene turned by half a turn about x,
// and awaits until the device is done.
const VIEWERS = {
  fixsplat: `const { load, Screen } = await import('/fixsplat.js')
    const screen = await Screen.open(canvas, 'webgpu'), placed = [{ scene: await load(url), rotation: [0, 1, 0, 0] }]
    return async (eye) => {
      screen.draw(placed, { eye, look, up: [0, 1, 0], fov }, { width, height })
      await screen.finish()
      await screen.device.queue.onSubmittedWorkDone()
    }`,
  PlayCanvas: `const pc = await import('playcanvas')
    const device = await pc.createGraphicsDevice(canvas, { deviceTypes: ['webgpu'], antialias: false })
    if (!device.isWebGPU) throw new Error('no WebGPU')
    const options = new pc.AppOptions()
    options.graphicsDevice = device
    options.componentSystems = [pc.RenderComponentSystem, pc.CameraComponentSystem, pc.LightComponentSystem,
      pc.GSplatComponentSystem]
    options.resourceHandlers = [pc.TextureHandler, pc.ContainerHandler, pc.GSplatHandler]
    const app = new pc.AppBase(canvas)
    app.init(options)
    app.setCanvasFillMode(pc.FILLMODE_NONE, width, height)
    app.setCanvasResolution(pc.RESOLUTION_FIXED, width, height)
    const asset = new pc.Asset('splats', 'gsplat', { url })
    await new Promise((done, fail) => {
      asset.ready(done)
      asset.on('error', fail)
      app.assets.add(asset)
      app.assets.load(asset)
    })
    const splats = new pc.Entity(), camera = new pc.Entity()
    splats.addComponent('gsplat', { asset })
    splats.setLocalEulerAngles(180, 0, 0)
    camera.addComponent('camera', { fov, nearClip: 0.1, clearColor: new pc.Color(0, 0, 0) })
    app.root.addChild(splats)
    app.root.addChild(camera)
    app.requestAnimationFrame = () => {} // a frame is drawn where it is asked for, not at the screen's rate
    app.start()
    return async (eye) => {
      camera.setPosition(...eye)
      camera.lookAt(...look)
      app.tick(performance.now())
      await device.wgpu.queue.onSubmittedWorkDone()
    }`,
  'three.js': `const THREE = await import('three/webgpu')
    const { GaussianSplat } = await import('three/addons/objects/GaussianSplat.js')
    const { GaussianSplatPLYLoader } = await import('three/addons/loaders/GaussianSplatPLYLoader.js')
    const renderer = new THREE.WebGPURenderer({ canvas })
    await renderer.init()
    if (!renderer.backend.device) throw new Error('no WebGPU')
    renderer.setSize(width, height, false)
    const world = new THREE.Scene(), camera = new THREE.PerspectiveCamera(fov, width / height, 0.1, 1000)
    const splats = new GaussianSplat(await new GaussianSplatPLYLoader().loadAsync(url))
    splats.rotation.x = Math.PI
    world.add(splats)
    return async (eye) => {
      camera.position.set(...eye)
      camera.lookAt(...look)
      renderer.render(world, camera)
      await renderer.backend.device.queue.onSubmittedWorkDone()
    }`,
}

const PAGE = `<!doctype html><style>body { margin: 0 }</style><canvas width="${width}" height="${height}"></canvas>
  <script type="importmap">${JSON.stringify({ imports: MAP })}</script>`
const places = { '/modules/': modules, '/scenes/': scenes, '/': folder }
const server = createServer((request, answer) => {
  const { pathname } = new URL(request.url, 'http://x')
  const place = Object.keys(places).find((start) => pathname.startsWith(start))
  const file = join(places[place], pathname.slice(place.length))
  answer.setHeader('content-type', pathname === '/' ? 'text/html' : (KINDS[pathname.split('.').pop()] ?? 'x/y'))
  answer.setHeader('cross-origin-opener-policy', 'same-origin')
  answer.setHeader('cross-origin-embedder-policy', 'require-corp')
  if (pathname === '/') answer.end(PAGE)
  else if (existsSync(file)) createReadStream(file).pipe(answer)
  else answer.writeHead(404).end()
}).listen(0, '127.0.0.1')
await new Promise((done) => server.once('listening', done))

const shown = (ms) => ms.toFixed(ms < 100 ? 2 : 0)
const median = (list) => [...list].sort((a, b) => a - b)[list.length >> 1]

async function measure(name) {
  const browser = await puppeteer.launch({
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
    args: ['--no-sandbox', ...WEBGPU],
    protocolTimeout: 600000,
  })
  try {
    const page = await browser.newPage()
    await page.setViewport({ width, height })
    await page.goto(`http://127.0.0.1:${server.address().port}/`)
    const times = await page.evaluate(`(async () => {
      const [canvas, width, height] = [document.querySelector('canvas'), ${width}, ${height}]
      const { eye, look, fov } = ${JSON.stringify(VIEWS[scene])}, url = '/scenes/${scene}/${scene}.ply'
      const [x, y, z] = eye.map((e, i) => e - look[i])
      const draw = await (async () => { ${VIEWERS[name]} })()
      const times = []
      for (let i = 0; i < ${FRAMES + 2}; i++) {
        const [s, c] = [Math.sin(0.035 * i), Math.cos(0.035 * i)], start = performance.now()
        await draw([look[0] + c * x + s * z, look[1] + y, look[2] - s * x + c * z])
        times.push(performance.now() - start)
      }
      return times.slice(2)
    })()`)
    if (process.env.PICTURES) await page.screenshot({ path: `${process.env.PICTURES}/${scene}-${name}.png` })
    return median(times)
  } finally {
    await browser.close()
  }
}

const names = asked.length ? asked : Object.keys(VIEWERS)
const found = Object.fromEntries(names.map((name) => [name, []]))
for (let round = 0; round < Number(rounds); round++)
  for (const name of names) found[name].push(await measure(name))
server.close()
for (const name of names) {
  const [own, first] = [median(found[name]), median(found[names[0]])]
  console.log(`${scene} ${size}, ${name}: ${shown(own)} ms a frame, ${(own / first).toFixed(2)} times ` +
    `${names[0]}'s; rounds ${found[name].map(shown).join(', ')}`)
}
const version = (name) => JSON.parse(readFileSync(join(modules, name, 'package.json'), 'utf8')).version
console.log(`playcanvas ${version('playcanvas')}, three ${version('three')}`)
