// Parts that webgl.mjs and webgpu.mjs share: a file server, functions that run code in pages, and frames to compare
// with the pictures of the command-line program.
import assert from 'node:assert/strict'
import { execFileSync } from 'node:child_process'
import { createReadStream, existsSync, readdirSync, readFileSync } from 'node:fs'
import { createServer } from 'node:http'
import { createRequire } from 'node:module'
import { join, resolve } from 'node:path'

export const [folder, work, modules, command, speed] = process.argv.slice(2)
const puppeteer = createRequire(resolve(modules, 'of'))('puppeteer-core')
const KINDS = { html: 'text/html', js: 'text/javascript', mjs: 'text/javascript', wasm: 'application/wasm' }

export function hash(bytes) {
  let h = 0xcbf29ce484222325n
  for (const byte of bytes) h = BigInt.asUintN(64, (h ^ BigInt(byte)) * 0x100000001b3n)
  return h.toString(16).padStart(16, '0')
}

const COMMON = `import { load, Screen } from '/fixsplat.js'
  export { Screen }
  export const canvas = () => new OffscreenCanvas(8, 8)
  const scenes = {}
  export const sceneOf = (name, options) =>
    (scenes[name + JSON.stringify(options)] ??= load('/work/' + name + '.fxs', options))
  export ${hash}
  export async function drawn(screen, { objects, camera, options }) {
    const placed = await Promise.all(objects.map(async (o) => ({ ...o, scene: await sceneOf(o.scene) })))
    screen.draw(placed, camera, options)
    return screen.pixels()
  }`
const WORKER = `import { drawn, hash, Screen } from '/common.js'
  onmessage = async ({ data: { canvas, backend, frames } }) => {
    try {
      const screen = await Screen.open(canvas, backend), hashes = []
      for (const frame of frames) hashes.push(hash(await drawn(screen, frame)))
      postMessage(hashes)
    } catch (error) {
      postMessage(error.message)
    }
  }`
const PAGE = '<!doctype html><title>fixsplat</title>'
const MAP = {
  imports: {
    three: '/three/three.module.js',
    'three/webgpu': '/three/three.webgpu.js',
    'three/tsl': '/three/three.tsl.js',
    playcanvas: '/playcanvas/playcanvas.mjs',
    fixsplat: '/fixsplat.js',
    'fixsplat-viewer/three': '/fixsplat-viewer/three.js',
    'fixsplat-viewer/playcanvas': '/fixsplat-viewer/playcanvas.js',
  },
}
const mapped = (map) => `${PAGE}<script type="importmap">${JSON.stringify(map)}</script>`
const [MESH, MESH_GPU] = [MAP, { imports: { ...MAP.imports, three: MAP.imports['three/webgpu'] } }].map(mapped)
const TEXTS = { '/': PAGE, '/isolated': PAGE, '/mesh': MESH, '/mesh-gpu': MESH_GPU, '/common.js': COMMON,
                '/worker.js': WORKER }
const FOLDERS = { work, examples: 'docs/examples', three: `${modules}/three/build`,
                  playcanvas: `${modules}/playcanvas/build`, 'fixsplat-viewer': join(folder, '../viewer') }
const OWN = { fixsplat: folder, 'fixsplat-viewer': FOLDERS['fixsplat-viewer'] }

function answerRange(file, range, answer) {
  const [first, last] = range.match(/\d+/g).map(Number)
  const all = readFileSync(file)
  const size = `bytes ${first}-${Math.min(last, all.length - 1)}/${all.length}`
  answer.writeHead(206, { etag: '"one"', 'content-range': size }).end(all.subarray(first, last + 1))
}

const server = createServer((request, answer) => {
  const { pathname, search } = new URL(request.url, 'http://x')
  const path = decodeURIComponent(pathname)
  const [, first, ...rest] = path.split('/')
  const npm = path.match(/^\/examples\/node_modules\/(fixsplat|fixsplat-viewer|three|playcanvas)(\/.*)/)
  const file = npm ? (OWN[npm[1]] ?? `${modules}/${npm[1]}`) + npm[2]
             : rest.length && FOLDERS[first] ? join(FOLDERS[first], ...rest) : folder + path
  const kind = TEXTS[path]?.startsWith(PAGE) ? 'text/html' : KINDS[path.split('.').pop()]
  answer.setHeader('content-type', kind ?? 'application/octet-stream')
  answer.setHeader('cross-origin-embedder-policy', 'require-corp')
  if (path === '/isolated') answer.setHeader('cross-origin-opener-policy', 'same-origin')
  if (TEXTS[path]) answer.end(TEXTS[path])
  else if (search === '?ranges' && request.headers.range) answerRange(file, request.headers.range, answer)
  else if (existsSync(file)) createReadStream(file).pipe(answer)
  else answer.writeHead(404).end()
}).listen(0, '127.0.0.1')
await new Promise((done) => server.once('listening', done))
export const base = `http://127.0.0.1:${server.address().port}/`

export const launch = (...args) =>
  puppeteer.launch({
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
    args: ['--no-sandbox', ...args],
    protocolTimeout: 600000,
  })

export async function open(browser, address) {
  const page = await browser.newPage()
  await page.goto(base + address)
  const run = (body, ...values) =>
    page.evaluate(`(async (...args) => {
      const { Screen, canvas, sceneOf, hash, drawn } = await import('/common.js')
      const wordsOf = (made) => made.then(() => 'nothing', (error) => error.message)
      ${body} })(...${JSON.stringify(values)})`)
  return { run, page, close: () => page.close() }
}

export async function runIn(browser, address, ...args) {
  const page = await open(browser, address)
  return page.run(...args).finally(page.close)
}

export const frame = (scene, width, height, args = [], options = {}, camera = {}, more = []) => ({
  objects: [{ scene }, ...more],
  camera,
  options: { width, height, ...options },
  args: [`${work}/${scene}.fxs`, ...more.map((o) => `${work}/${o.scene}.fxs`), '--size', `${width}x${height}`, ...args],
})

export const hashOf = ({ args }) =>
  execFileSync(command, ['render', ...args, '-o', `${work}/picture.ppm`, '--hash'], { encoding: 'utf8' }).trim()

export const near = { eye: [2, -1, -4], look: [0, 0.3, 0], fov: 65, up: [0.1, -1, 0.2], near: 0.5 }
const nearly = ['--eye', '2,-1,-4', '--look', '0,0.3,0', '--fov', '65', '--up', '0.1,-1,0.2', '--near', '0.5']
const turned = { translation: [1, 0.5, -2], rotation: [0.5, 0.5, -0.5, 0.5], scale: 0.75 }
export const FRAMES = {
  framed: frame('knot', 320, 200),
  'eye, look and background': frame('knot', 131, 77, [...nearly, '--bg', '112233'], { background: 0x112233 }, near),
  'coverage, SH degree 1': frame('knot', 201, 149, ['--alpha', '--sh-degree', '1'], { alpha: true, shDegree: 1 }),
  'square cut-off': frame('fog', 200, 150, ['--cutoff', 'square', '--bg', 'ffffff'],
                          { cutoff: 'square', background: 0xffffff }),
  'a budget': frame('levels', 200, 150, ['--budget', '6000', ...nearly], { budget: 6000 }, near),
  'in bands': frame('knot', 200, 150, ['--max-memory', '900000'], { maxMemory: 900000 }),
  'two objects': frame('knot', 200, 150,
                       ['--eye', '1,-2,-9', '--place', `${work}/fog.fxs:1,0.5,-2,0.5,0.5,-0.5,0.5,0.75`],
                       {}, { eye: [1, -2, -9] }, [{ scene: 'fog', ...turned }]),
  'one pixel': frame('knot', 1, 1),
  'a list in parts': frame('fog', 17, 16),
  'a row of tiles': frame('knot', 640, 5),
  'larger again': frame('knot', 640, 480),
}
export const shared = readdirSync(work).flatMap((name) => name.match(/^(shared-.*)\.fxs$/)?.[1] ?? [])

export async function drawsOverBackdrop(run, ...backends) {
  const [over, ...seen] = await run(
    `const { render } = await import('/fixsplat.js')
    const { objects: [{ scene }], camera, options } = args[0]
    const backdrop = Uint8Array.from({ length: 4 * options.width * options.height }, (_, i) => (i * 37 + (i >> 9)) % 251)
    const placed = [{ scene: await sceneOf(scene) }]
    const seen = [hash(render(placed, camera, { ...options, targets: { colour: true, backdrop } }).colour)]
    for (const backend of args[1]) {
      const screen = await Screen.open(canvas(), backend)
      for (const more of [{ backdrop }, {}, { backdrop }]) {
        screen.draw(placed, camera, { ...options, ...more })
        seen.push(hash(await screen.pixels()))
      }
      const short = { ...options, backdrop: backdrop.subarray(4) }
      seen.push(screen.gl?.getError() || (await wordsOf((async () => screen.draw(placed, camera, short))())))
      screen.free()
    }
    return seen`,
    FRAMES.framed,
    backends
  )
  const plain = hashOf(FRAMES.framed)
  assert.notEqual(over, plain)
  const count = 4 * 320 * 200
  assert.deepEqual(seen, backends.flatMap(() => [over, plain, over, `backdrop: expected ${count} numbers`]))
}

export async function runTests(browser, tests, measure) {
  let failed = 0
  const only = new RegExp(process.env.ONLY ?? '')
  for (const [name, test] of Object.entries(tests).filter(([name]) => only.test(name)))
    try {
      const start = performance.now()
      await test()
      console.log(`ok ${name}`)
      if (process.env.TIMES) console.log(performance.now() - start)
    } catch (error) {
      failed = 1
      console.log(`FAIL ${name}: ${error.message}`)
    }
  if (speed && shared.length) await measure()
  await browser.close()
  server.close()
  process.exit(failed)
}
