// node dawn.mjs PACKAGE SCENES MODULES COMMAND [SIZE [ROUNDS [SCENE...]]]: checks and times drawing with WebGPU in
// Node, by the library Dawn. The environment variable VK_DRIVER_FILES chooses a Vulkan driver. FRAMES is the number of
// frames for the median (7), PICTURES a folder for pictures.
import { execFileSync } from 'node:child_process'
import { readFileSync, writeFileSync } from 'node:fs'
import { createServer } from 'node:http'
import { createRequire } from 'node:module'
import { tmpdir } from 'node:os'
import { join, resolve } from 'node:path'
import { fileURLToPath, pathToFileURL } from 'node:url'
import { serveRanges } from './ranges.mjs'
import { inTurns, measureText, median, VIEWERS } from './viewers.mjs'

const [folder, scenes, modules, command, size = '1280x720', rounds = '3', ...asked] = process.argv.slice(2)
const [width, height] = size.split('x').map(Number)
const FRAMES = Number(process.env.FRAMES ?? 7)
const find = createRequire(resolve(modules, 'of')).resolve
const fileOf = (scene) => join(resolve(scenes), scene, `${scene}.ply`)
const FILES = { fixsplat: join(resolve(folder), 'fixsplat.js'), webgpu: find('webgpu'),
  playcanvas: join(resolve(modules), 'playcanvas/build/playcanvas.mjs'),
  'three/webgpu': join(resolve(modules), 'three/build/three.webgpu.js') }
const bring = (name) =>
  import(pathToFileURL(FILES[name] ?? join(resolve(modules), name.replace('three/addons', 'three/examples/jsm'))))

const { create, globals } = await bring('webgpu')
Object.assign(globalThis, globals)
const gpu = create([])
Object.defineProperty(globalThis, 'navigator', { value: { gpu, userAgent: 'node' }, configurable: true })

function makePage() {
  const shown = {}
  const listens = { addEventListener() {}, removeEventListener() {} }
  const usage = GPUTextureUsage.RENDER_ATTACHMENT | GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_SRC
  const context = {
    configure({ device, format }) {
      Object.assign(shown, { device, texture: device.createTexture({ size: [width, height], format, usage }) })
    },
    unconfigure() {},
    getCurrentTexture: () => shown.texture,
  }
  const element = { ...listens, style: {}, setAttribute() {}, getContext: (kind) => (kind === 'webgpu' ? context : null) }
  const rectangle = { left: 0, top: 0, width, height }
  const canvas = { ...element, width, height, clientWidth: width, clientHeight: height,
                   getBoundingClientRect: () => rectangle }
  canvas.getRootNode = () => canvas
  class Nothing {}
  Object.assign(globalThis, listens, { self: globalThis, window: globalThis, screen: {}, devicePixelRatio: 1,
    document: { ...listens, createElement: () => element, documentElement: {}, body: {}, head: {} },
    requestAnimationFrame: () => 0, cancelAnimationFrame() {}, HTMLCanvasElement: Nothing, HTMLImageElement: Nothing,
    HTMLVideoElement: Nothing, ImageBitmap: Nothing, ProgressEvent: Nothing })
  return { canvas, shown }
}

async function putPicture({ device, texture }, path) {
  const bytesPerRow = Math.ceil((4 * width) / 256) * 256
  const buffer = device.createBuffer({ size: bytesPerRow * height, usage: GPUBufferUsage.MAP_READ | GPUBufferUsage.COPY_DST })
  const encoder = device.createCommandEncoder()
  encoder.copyTextureToBuffer({ texture }, { buffer, bytesPerRow }, [width, height])
  device.queue.submit([encoder.finish()])
  await buffer.mapAsync(GPUMapMode.READ)
  const bytes = new Uint8Array(buffer.getMappedRange()), red = texture.format.startsWith('bgra') ? 2 : 0
  const pixels = Buffer.alloc(3 * width * height)
  for (let i = 0; i < width * height; i++)
    for (let k = 0; k < 3; k++)
      pixels[3 * i + k] = bytes[Math.floor(i / width) * bytesPerRow + (i % width) * 4 + (k === 1 ? 1 : k ^ red)]
  writeFileSync(path, Buffer.concat([Buffer.from(`P6\n${width} ${height}\n255\n`), pixels]))
}

async function measureHere(name, scene) {
  const server = createServer((_, answer) => answer.end(readFileSync(fileOf(scene)))).listen(0, '127.0.0.1')
  await new Promise((done) => server.once('listening', done))
  const url = `http://127.0.0.1:${server.address().port}/${scene}.ply`
  globalThis.location = new URL(url)
  const { canvas, shown } = makePage()
  const AsyncFunction = (async () => {}).constructor
  const measure = new AsyncFunction('bring', 'canvas', 'url', 'width', 'height', 'frames', measureText(name, scene))
  console.log(median(await measure(bring, canvas, url, width, height, FRAMES)))
  if (process.env.PICTURES) await putPicture(shown, join(process.env.PICTURES, `${scene}-${name}.ppm`))
  process.exit()
}

/** Draws a scene until nothing is missing, and compares with the command's picture of `file`. */
async function isSame(scene, file, camera, options, ...args) {
  const { Screen } = await bring('fixsplat')
  const screen = await Screen.open(null, 'webgpu')
  const colour = screen.device.createBuffer({ size: 4 * width * height,
                                              usage: GPUBufferUsage.MAP_READ | GPUBufferUsage.COPY_DST })
  for (let missing = 1; missing; await screen.finish()) {
    if (scene.paged) await scene.complete(camera, { ...options, width, height })
    missing = screen.draw([{ scene }], camera, { ...options, width, height, targets: { colour } }).missing
  }
  await colour.mapAsync(GPUMapMode.READ)
  const raw = join(tmpdir(), `dawn-${process.pid}.raw`)
  execFileSync(command, ['render', file, '--size', size, ...args, '-o', raw, '--quiet'])
  const same = Buffer.from(colour.getMappedRange()).equals(readFileSync(raw))
  screen.free()
  return same
}

async function isSameStreamed(scene) {
  const { load } = await bring('fixsplat')
  const file = join(tmpdir(), `dawn-${process.pid}.fxs`)
  execFileSync(command, ['convert', fileOf(scene), file, '--levels'], { stdio: 'ignore' })
  const server = await serveRanges(file)
  const streamed = await load(server.url)
  const args = ['--eye', '2,-1,-4', '--budget', '200000']
  const same = await isSame(streamed, file, { eye: [2, -1, -4] }, { budget: 200000 }, ...args)
  streamed.free()
  server.close()
  return streamed.paged && same
}

if (process.env.VIEWER) await measureHere(process.env.VIEWER, asked[0])
const adapter = await gpu.requestAdapter()
if (!adapter) throw new Error('Dawn finds no adapter')
console.log(`Dawn: ${adapter.info.vendor}, ${adapter.info.architecture}, ${adapter.info.description}`)
let failed = 0
for (const scene of asked.length ? asked : ['guitar', 'snowmiku']) {
  const { load } = await bring('fixsplat')
  const whole = await isSame(await load(fileOf(scene)), fileOf(scene), {}, {})
  const streamed = await isSameStreamed(scene)
  failed += !whole + !streamed
  console.log(`${whole ? 'ok  ' : 'FAIL'} ${scene} ${size}: the pixels of the command`)
  console.log(`${streamed ? 'ok  ' : 'FAIL'} ${scene} ${size}: the pixels of the command, streamed`)
  await inTurns(Object.keys(VIEWERS), Number(rounds), `${scene} ${size}`, (VIEWER) => Number(
    execFileSync(process.execPath, [fileURLToPath(import.meta.url), folder, scenes, modules, command, size, rounds, scene],
                 { env: { ...process.env, VIEWER }, encoding: 'utf8' }).trim().split('\n').pop()))
}
process.exit(failed ? 1 : 0)
