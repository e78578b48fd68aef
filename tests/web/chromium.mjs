// Parts that tests of the viewer's page share: a file server, headless Chromium, and the viewer in a page.
import assert from 'node:assert/strict'
import { execFileSync } from 'node:child_process'
import { closeSync, createReadStream, existsSync, openSync, readFileSync, readSync, statSync } from 'node:fs'
import { createServer } from 'node:http'
import { createRequire } from 'node:module'
import { resolve } from 'node:path'
import { WEBGL, WEBGPU } from './flags.mjs'

export const [folder, scenes, modules, pictures, command] = process.argv.slice(2)
const puppeteer = createRequire(resolve(modules, 'of'))('puppeteer-core')
const KINDS = {
  js: 'text/javascript',
  html: 'text/html',
  css: 'text/css',
  wasm: 'application/wasm',
  json: 'application/json',
  png: 'image/png',
}

export const pause = (ms) => new Promise((done) => setTimeout(done, ms))

/** for each name of a served file, a function that changes its text */
export const changes = {}
/** State of the scene server: `sent` is the number of bytes sent, `wait` a delay in seconds, `rate` a limit in bytes a
    second for all answers together, and `tag` the ETag. */
export const ranges = { sent: 0, wait: 0, tag: '"one"' }
export const policy = { text: '' }
const SLOW = 1500

async function answer(request, response) {
  const { pathname, search } = new URL(request.url, 'http://x')
  const path = decodeURIComponent(pathname.replace(/%(?![0-9a-f]{2})/gi, '%25'))
  const file = path.startsWith('/scenes/') ? scenes + path.slice(7) : folder + path
  if (!existsSync(file)) return response.writeHead(404).end()
  response.setHeader('cross-origin-opener-policy', 'same-origin')
  response.setHeader('cross-origin-embedder-policy', 'require-corp')
  if (policy.text) response.setHeader('content-security-policy', policy.text)
  response.setHeader('content-type', KINDS[file.split('.').pop()] ?? 'application/octet-stream')
  if (search.includes('slow')) await pause(SLOW)
  if (search.includes('cut')) {
    response.setHeader('content-length', 100000)
    response.write(readFileSync(file).subarray(0, 5000), () => setTimeout(() => response.destroy(), 50))
  } else if (changes[path]) response.end(changes[path](readFileSync(file, 'utf8')))
  else if (search.includes('trickle')) await trickle(readFileSync(file), response)
  else if (search.includes('ranges') && request.headers.range) await answerRange(file, request, response)
  else {
    response.setHeader('content-length', statSync(file).size)
    createReadStream(file).pipe(response)
  }
}

const TRICKLE = [[0.03, 0], [0.031, 700], [1, 200]]

async function trickle(bytes, response) {
  response.setHeader('content-length', bytes.length)
  let at = 0
  for (const [share, wait] of TRICKLE) {
    await pause(wait)
    response.write(bytes.subarray(at, (at = Math.floor(share * bytes.length))))
  }
  response.end()
}

let due = 0

async function answerRange(file, { headers }, response) {
  const [first, last] = headers.range.match(/\d+/g).map(Number)
  const { size } = statSync(file)
  if (ranges.wait) await pause(1000 * ranges.wait)
  const bytes = Buffer.alloc(Math.min(last + 1, size) - first)
  const opened = openSync(file)
  readSync(opened, bytes, 0, bytes.length, first)
  closeSync(opened)
  if (ranges.rate) {
    due = Math.max(due, performance.now()) + 1000 * bytes.length / ranges.rate
    await pause(due - performance.now())
  }
  ranges.sent += bytes.length
  response.setHeader('etag', ranges.tag)
  response.setHeader('content-range', `bytes ${first}-${last}/${size}`)
  response.writeHead(206).end(bytes)
}

const server = createServer(answer).listen(0, '127.0.0.1')
await new Promise((done) => server.once('listening', done))
export const base = `http://127.0.0.1:${server.address().port}`

const browser = await puppeteer.launch({
  executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
  protocolTimeout: 600000,
  args: ['--no-sandbox', ...(process.env.WEBGPU ? WEBGPU : WEBGL),
    '--enable-blink-features=ForceEagerMeasureMemory', '--host-resolver-rules=MAP far.test 127.0.0.1'],
})
export const page = await browser.newPage()
export async function processes(kind) {
  const session = await browser.target().createCDPSession()
  const { processInfo } = await session.send('SystemInfo.getProcessInfo')
  return processInfo.filter(({ type }) => type === kind).map(({ id }) => id)
}

export const faults = []
page.on('pageerror', (error) => faults.push(error.message))
export const strange = []
page.on(
  'request',
  (request) => !/^(http:\/\/127\.0\.0\.1|data:|blob:)/.test(request.url()) && strange.push(request.url())
)
await page.emulateMediaFeatures([{ name: 'prefers-color-scheme', value: 'dark' }])

export async function go(address, width = 640, height = 360) {
  await page.setViewport({ width, height })
  await page.goto('about:blank')
  await page.goto(`${base}/viewer/index.html${address}`)
}

export async function without(replace, run) {
  const { identifier } = await page.evaluateOnNewDocument(replace)
  try {
    await run()
  } finally {
    await page.removeScriptToEvaluateOnNewDocument(identifier)
  }
}

export async function changed(path, change, run) {
  let isSame = false
  changes[path] = (text) => {
    const result = change(text)
    isSame = result === text
    return result
  }
  try {
    await run()
  } finally {
    delete changes[path]
    if (isSame) throw new Error(`${path}: the text to change is not there`)
  }
}

export const inside = (body, ...args) =>
  page.evaluate(`(async (...args) => { const v = document.querySelector('fixsplat-viewer');
    const $ = (id) => v.shadowRoot.getElementById(id);
    ${body} })(...${JSON.stringify(args)})`)

export const still = () =>
  page.waitForSelector('fixsplat-viewer[state=still]', { timeout: Number(process.env.WAIT ?? 300000) })

const QUIET_MS = 250

export async function moved() {
  await inside(`for (let i = 0; i < 2; i++) {
      await v.pick(0, 0)
      for (let k = 0; k < 3; k++) await new Promise(requestAnimationFrame)
    }
    let [since, view] = [performance.now(), '']
    while (performance.now() - since < ${QUIET_MS}) {
      await new Promise(requestAnimationFrame)
      if (v.state !== 'still' || v.view !== view) since = performance.now()
      view = v.view
    }`)
  await still()
}

export async function open(address, ...size) {
  await go(address, ...size)
  await still()
}

export async function wordsOf() {
  await page.waitForFunction(
    () => !document.querySelector('fixsplat-viewer').shadowRoot.getElementById('error').hidden
  )
  return inside(`return $('words').textContent`)
}

export const engineOf = () => page.workers().find((worker) => worker.url().endsWith('/viewer/worker.js'))
export const viewOf = () => inside('return v.view')
export const picture = (name) => page.screenshot({ path: `${pictures}/${name}.png` })

export async function shown() {
  await pause(250)
  return inside(`const seen = await createImageBitmap($('stage').lastElementChild), { width, height } = seen;
    const copy = new OffscreenCanvas(width, height).getContext('2d');
    copy.drawImage(seen, 0, 0);
    const { data } = copy.getImageData(0, 0, width, height);
    let h = 0xcbf29ce484222325n;
    for (const b of data) h = BigInt.asUintN(64, (h ^ BigInt(b)) * 0x100000001b3n);
    return { size: [width, height], hash: h.toString(16).padStart(16, '0') }`)
}
export const hash = async () => (await shown()).hash

export function rendered(scene, ...options) {
  const words = execFileSync(command, ['render', `${scenes}/${scene}`, '--hash', ...options], { encoding: 'utf8' })
  return words.trim().split(/\s/)[0]
}

export function native(scene, view, size, background = '0e1116', ...more) {
  const n = view.split(',')
  const camera = ['--eye', n.slice(0, 3).join(), '--look', n.slice(3, 6).join(), '--up', n.slice(6, 9).join()]
  return rendered(scene, ...camera, '--fov', n[9], '--size', size, '--bg', background, ...more)
}

export async function run(tests) {
  const only = new RegExp(process.env.ONLY ?? "")
  for (const [name, test] of Object.entries(tests).filter(([name]) => only.test(name))) {
    try {
      faults.length = 0
      const start = performance.now()
      await test()
      assert.deepEqual(faults, [])
      console.log(`ok ${name}${process.env.TIMES ? ` ${((performance.now() - start) / 1000).toFixed(1)} s` : ''}`)
    } catch (error) {
      console.log(`FAIL ${name}: ${error.stack}`)
      process.exitCode = 1
    }
  }
  await browser.close()
  server.close()
}
