// node webgpu_peers.mjs PACKAGE SCENES MODULES [ROUNDS [SCENE [SIZE [VIEWER...]]]]: times WebGPU frames of the viewers
// fixsplat, PlayCanvas and three.js, in turns. The environment variable FRAMES is the number of frames for the median
// (7).
import { createReadStream, existsSync, readFileSync } from 'node:fs'
import { createServer } from 'node:http'
import { createRequire } from 'node:module'
import { join, resolve } from 'node:path'
import { WEBGPU } from './flags.mjs'
import { inTurns, measureText, median, VIEWERS } from './viewers.mjs'

const [folder, scenes, modules, rounds = '3', scene = 'guitar', size = '1280x720', ...asked] = process.argv.slice(2)
const puppeteer = createRequire(resolve(modules, 'of'))('puppeteer-core')
const KINDS = { js: 'text/javascript', mjs: 'text/javascript', wasm: 'application/wasm', html: 'text/html' }
const MAP = { three: '/modules/three/build/three.webgpu.js', 'three/webgpu': '/modules/three/build/three.webgpu.js',
  'three/tsl': '/modules/three/build/three.tsl.js', 'three/addons/': '/modules/three/examples/jsm/',
  playcanvas: '/modules/playcanvas/build/playcanvas.min.mjs', fixsplat: '/fixsplat.js' }
const FRAMES = Number(process.env.FRAMES ?? 7)
const [width, height] = size.split('x').map(Number)

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
    const times = await page.evaluate(`(async (url, width, height, frames) => {
      const [bring, canvas] = [(name) => import(name), document.querySelector('canvas')]
      ${measureText(name, scene)} })('/scenes/${scene}/${scene}.ply', ${width}, ${height}, ${FRAMES})`)
    if (process.env.PICTURES) await page.screenshot({ path: `${process.env.PICTURES}/${scene}-${name}.png` })
    return median(times)
  } finally {
    await browser.close()
  }
}

await inTurns(asked.length ? asked : Object.keys(VIEWERS), Number(rounds), `${scene} ${size}`, measure)
server.close()
const version = (name) => JSON.parse(readFileSync(join(modules, name, 'package.json'), 'utf8')).version
console.log(`playcanvas ${version('playcanvas')}, three ${version('three')}`)
