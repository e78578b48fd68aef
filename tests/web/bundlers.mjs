// node bundlers.mjs TARBALL WORK MODULES PUPPETEER COMMAND [all]: the package as npm installs it, in programs that
// bundlers of MODULES make, and by a line without any. Each is opened in Chromium, isolated, and draws the pictures of
// the command by every module of WebAssembly, with threads, and by the element. Prints a table at the end. WORK has
// scene.ply; projects are made beside MODULES, as programs have their modules above them.
import assert from 'node:assert/strict'
import { execFile, execFileSync, spawn } from 'node:child_process'
import { cpSync, existsSync, mkdirSync, mkdtempSync, readdirSync, readFileSync, rmSync, statSync, writeFileSync } from 'node:fs'
import { createServer, request as ask } from 'node:http'
import { createRequire } from 'node:module'
import { connect } from 'node:net'
import { dirname, join, resolve } from 'node:path'
import { promisify } from 'node:util'
import { WEBGL } from './flags.mjs'

const [tarball, work, modules, puppeteers, command, all] = process.argv.slice(2)
const puppeteer = createRequire(resolve(puppeteers, 'of'))('puppeteer-core')
const only = new RegExp(process.env.ONLY ?? '')
const here = import.meta.dirname ?? dirname(new URL(import.meta.url).pathname)
const home = mkdtempSync(join(dirname(resolve(modules)), 'try-'))
process.on('exit', () => rmSync(home, { recursive: true, force: true }))
for (const signal of ['SIGINT', 'SIGTERM']) process.on(signal, () => process.exit(1))

const run = promisify(execFile)
const pause = (milliseconds) => new Promise((done) => setTimeout(done, milliseconds))
const rendered = (...options) =>
  execFileSync(command, ['render', join(work, 'scene.ply'), '--hash', ...options], { encoding: 'utf8' }).trim().split(/\s/)[0]
const WANTED = rendered('--size', '64x48', '--eye', '2,-1,-4')
const VIEW = ['--eye', '0.3,-0.9,-4', '--look', '0,0,0', '--up', '0,-1,0', '--fov', '45']
const WANTED_VIEW = rendered('--size', '320x200', '--bg', '0e1116', ...VIEW)
const WANTED_TURNED = rendered('--size', '320x200', '--bg', '0e1116', ...VIEW, '--fov', '60')

// ---- Projects -----------------------------------------------------------------------------------------------------

/** What npm installs of the tarball, once. */
const installed = join(home, 'installed')
mkdirSync(installed)
writeFileSync(join(installed, 'package.json'), '{ "private": true }')
execFileSync('npm', ['install', '--offline', '--ignore-scripts', '--no-audit', '--no-fund', '--loglevel=error', resolve(tarball)],
  { cwd: installed, stdio: 'pipe' })
const published = join(installed, 'node_modules/fixsplat')

const PAGE = (scripts) => `<!doctype html><meta charset="utf-8"><title>x</title><link rel="icon" href="data:,"><body>${scripts}</body>`
const MODULE = '<script type="module" src="/main.js"></script>'
const mainOf = (load, viewer) =>
  readFileSync(join(here, 'bundlers/main.js'), 'utf8').replace('@LOAD@', load).replace('@VIEWER@', viewer)
const MAIN = mainOf('fixsplat', 'fixsplat/viewer')
const INLINE = mainOf('fixsplat/inline', 'fixsplat/inline/viewer')
const REACT = readFileSync(join(here, '../../docs/examples/react.jsx'), 'utf8')

/** A folder with these files and the package. */
function project(name, files) {
  const folder = join(home, name.replace(/\W+/g, '_'))
  const write = (path, text) => {
    mkdirSync(dirname(join(folder, path)), { recursive: true })
    writeFileSync(join(folder, path), text)
  }
  write('package.json', `{ "private": true, "type": "module" }`)
  for (const [path, text] of Object.entries(files)) write(path, text)
  cpSync(published, join(folder, 'node_modules/fixsplat'), { recursive: true })
  return folder
}

/** The script of a program of MODULES. */
function programOf(name) {
  const [module, key = name] = name.split('#')
  const folder = join(resolve(modules), module)
  const { bin } = JSON.parse(readFileSync(join(folder, 'package.json'), 'utf8'))
  return join(folder, typeof bin === 'string' ? bin : bin[key])
}

const quiet = { NEXT_TELEMETRY_DISABLED: '1', PARCEL_WORKERS: '0', NO_COLOR: '1', CI: '1' }
const environment = { ...process.env, ...quiet, NODE_ENV: undefined }

async function build(folder, [program, ...args]) {
  const { stdout, stderr } = await run(process.execPath, [programOf(program), ...args],
    { cwd: folder, env: environment, maxBuffer: 1e8 }).catch((error) => {
    throw new Error(`${program} ${args.join(' ')}: ${error.stdout}${error.stderr}`)
  })
  return stdout + stderr
}

// ---- Servers ------------------------------------------------------------------------------------------------------

const KINDS = { js: 'text/javascript', mjs: 'text/javascript', html: 'text/html', css: 'text/css', wasm: 'application/wasm' }
const ISOLATED = { 'cross-origin-opener-policy': 'same-origin', 'cross-origin-embedder-policy': 'require-corp' }

function listening(server) {
  server.sockets = new Set()
  server.on('connection', (socket) => {
    server.sockets.add(socket)
    socket.on('close', () => server.sockets.delete(socket))
  })
  return new Promise((done) => server.listen(0, '127.0.0.1', () => done(server.address().port)))
}

function closed(server) {
  for (const socket of server.sockets) socket.destroy()
  return new Promise((done) => server.close(done))
}

/** A folder, the scene, and the package's files under /published. */
async function serveFiles(folder, headers = ISOLATED) {
  const server = createServer((request, response) => {
    const path = decodeURIComponent(new URL(request.url, 'http://x').pathname).replace(/\/$/, '/index.html')
    const file = path.startsWith('/published/') ? join(published, path.slice(10)) : join(path === '/scene.ply' ? work : folder, path)
    for (const [name, value] of Object.entries(headers)) response.setHeader(name, value)
    if (!existsSync(file) || !statSync(file).isFile()) return response.writeHead(404).end()
    response.setHeader('content-type', KINDS[file.split('.').pop()] ?? 'application/octet-stream')
    response.end(readFileSync(file))
  })
  const port = await listening(server)
  return { address: `http://127.0.0.1:${port}/`, end: () => closed(server) }
}

/** A development server behind one that isolates its pages and has the scene. */
async function serveProgram(folder, [program, ...args]) {
  const probe = createServer()
  const port = await listening(probe)
  await closed(probe)
  const child = spawn(process.execPath, [programOf(program), ...args.map((arg) => arg.replace('PORT', port))],
    { cwd: folder, env: environment, detached: true, stdio: ['ignore', 'pipe', 'pipe'] })
  let said = ''
  for (const stream of [child.stdout, child.stderr]) stream.on('data', (text) => (said += text))
  const over = new Promise((done) => child.on('exit', done))
  const end = async () => {
    if (child.exitCode === null) process.kill(-child.pid, 'SIGKILL')
    await over
  }
  const pass = (request, response) => {
    if (request.url === '/scene.ply') return response.writeHead(200, ISOLATED).end(readFileSync(join(work, 'scene.ply')))
    const { url: path, method, headers } = request
    const asked = ask({ host: '127.0.0.1', port, path, method, headers: { ...headers, host: `127.0.0.1:${port}` } }, (answer) => {
      response.writeHead(answer.statusCode, { ...answer.headers, ...ISOLATED })
      answer.pipe(response)
    })
    asked.on('error', () => response.destroy())
    request.pipe(asked)
  }
  const server = createServer(pass)
  server.on('upgrade', (request, socket, head) => {
    const other = connect(port, '127.0.0.1', () => {
      const lines = Object.entries({ ...request.headers, host: `127.0.0.1:${port}`, origin: `http://127.0.0.1:${port}` })
      other.write(`GET ${request.url} HTTP/1.1\r\n${lines.map(([name, value]) => `${name}: ${value}\r\n`).join('')}\r\n`)
      other.write(head)
      socket.pipe(other).pipe(socket)
    })
    for (const one of [socket, other]) one.on('error', () => (socket.destroy(), other.destroy()))
  })
  const answers = () => new Promise((done) => {
    const asked = ask({ host: '127.0.0.1', port, path: '/' }, (answer) => (answer.resume(), done(true)))
    asked.on('error', () => done(false)).end()
  })
  for (let i = 0; i < 600 && child.exitCode === null && !(await answers()); i++) await pause(100)
  if (child.exitCode !== null) throw new Error(`${program}: ${said}`)
  const address = `http://127.0.0.1:${await listening(server)}/`
  return { address, said: () => said, end: () => Promise.all([closed(server), end()]) }
}

// ---- In Chromium --------------------------------------------------------------------------------------------------

const browser = await puppeteer.launch({
  executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
  args: ['--no-sandbox', ...WEBGL],
})

/** Opens a page; what it says is wrong is held against it. */
async function opened(address, see) {
  const page = await browser.newPage()
  const faults = []
  page.on('pageerror', (error) => faults.push(error.message))
  page.on('response', (answer) => answer.status() >= 400 && faults.push(`${answer.status()} ${answer.url()}`))
  page.on('requestfailed', (asked) => !/ERR_ABORTED/.test(asked.failure()?.errorText) && faults.push(`${asked.failure()?.errorText} ${asked.url()}`))
  page.on('console', (line) => line.type() === 'error' && faults.push(line.text()))
  try {
    await page.emulateMediaFeatures([{ name: 'prefers-color-scheme', value: 'dark' }])
    await page.goto(address)
    await see(page)
    assert.deepEqual(faults, [])
  } catch (error) {
    if (process.env.PICTURES) await page.screenshot({ path: join(process.env.PICTURES, 'fault.png') }).catch(() => {})
    throw new Error(`${error.message}\n${faults.join('\n')}`, { cause: error })
  } finally {
    await page.close()
  }
}

const until = async (page, is, words, ...args) =>
  page.waitForFunction(is, { timeout: 120000, polling: 50 }, ...args).catch(async () => {
    throw new Error(`${words}: ${JSON.stringify(await page.evaluate(() => ({ result: globalThis.result, said: globalThis.said,
      state: document.querySelector('fixsplat-viewer')?.getAttribute('state') })))}`)
  })

/** The hash of what the element shows, when it rests. */
async function shown(page) {
  await until(page, () => document.querySelector('fixsplat-viewer')?.getAttribute('state') === 'still', 'the element does not come to rest')
  await pause(250)
  return page.evaluate(async () => {
    const seen = await createImageBitmap(document.querySelector('fixsplat-viewer').shadowRoot.getElementById('stage').lastElementChild)
    const copy = new OffscreenCanvas(seen.width, seen.height).getContext('2d')
    copy.drawImage(seen, 0, 0)
    let h = 0xcbf29ce484222325n
    for (const b of copy.getImageData(0, 0, seen.width, seen.height).data) h = BigInt.asUintN(64, (h ^ BigInt(b)) * 0x100000001b3n)
    return h.toString(16).padStart(16, '0')
  })
}

/** All that main.js and the element are to do. */
async function works(page, { isolated = true, inline = false } = {}) {
  await until(page, () => globalThis.result, 'the program does not end')
  const threads = isolated ? 2 : 1
  assert.equal(await page.evaluate(() => crossOriginIsolated), isolated)
  const { error, threaded, single, plain, webgl } = await page.evaluate(() => globalThis.result)
  assert.equal(error, undefined, error)
  assert.deepEqual([threaded, single, webgl], [{ threads, hash: WANTED }, { threads: 1, hash: WANTED }, WANTED])
  if (inline) assert.match(plain, /core\.wasm: is no part of fixsplat\/inline/)
  else assert.deepEqual(plain, { threads: 1, hash: WANTED })
  assert.equal(await shown(page), WANTED_VIEW, 'the element shows another picture')
  // The element's worker, and with threads one for it and one for the program.
  assert.equal(page.workers().length, isolated ? 3 : 1, 'workers')
  await page.evaluate(() => document.querySelector('fixsplat-viewer').setAttribute('backend', 'webgl2'))
  await until(page, () => document.querySelector('fixsplat-viewer').backend === 'webgl2', 'no WebGL 2 in the worker')
  assert.equal(await shown(page), WANTED_VIEW, 'the element shows another picture by WebGL 2')
  assert.equal(await page.evaluate(() => globalThis.said), undefined)
}

/** docs/examples/react.jsx: the element comes, gets another view, and goes with its worker. */
async function reacts(page) {
  assert.equal(await shown(page), WANTED_VIEW)
  await page.click('#wider')
  await pause(600)
  assert.equal(await shown(page), WANTED_TURNED)
  await page.click('#shown')
  await until(page, () => !document.querySelector('fixsplat-viewer'), 'the element stays')
  for (let i = 0; i < 100 && page.workers().length; i++) await pause(50)
  assert.equal(page.workers().length, 0, 'its workers stay')
  await page.click('#shown')
  assert.equal(await shown(page), WANTED_TURNED)
}

// ---- Cases --------------------------------------------------------------------------------------------------------

const table = {}
/** A case of a tool, and the columns of the table that it proves. */
const cases = []
const add = (tool, name, columns, run, isQuick = false) => cases.push({ tool, name, columns, run, isQuick })
const EVERYTHING = ['worker', 'wasm', 'element']

/** A minifier gives functions names of its own. */
function isSmall(folder) {
  const scripts = readdirSync(folder, { recursive: true }).filter((name) => /\.m?js$/.test(name))
  assert.ok(scripts.length > 0)
  for (const name of scripts) assert.doesNotMatch(readFileSync(join(folder, name), 'utf8'), /sharedMemory/, `${name} is not minified`)
}

// What webpack says of import.wasm, which is larger than it likes.
const SIZES = /WARNING in (asset|entrypoint) size limit|compiled with \d warnings? in/g

async function built(name, files, commands, out, how = {}) {
  const folder = project(name, files)
  for (const command of commands) {
    const said = await build(folder, command)
    assert.doesNotMatch(said.replace(SIZES, ''), /\bwarn(ing)?\b/i, said)
  }
  if (how.page) writeFileSync(join(folder, out, 'index.html'), PAGE(how.page))
  isSmall(join(folder, out))
  await shows(join(folder, out), how)
}

/** A folder in a page that has threads, and in one that has none. */
async function shows(folder, how = {}) {
  for (const isolated of all ? [true, false] : [true]) {
    const server = await serveFiles(folder, { ...(isolated ? ISOLATED : {}), ...how.headers })
    await opened(`${server.address}${how.hash ?? ''}`, (page) => (how.see ?? works)(page, { ...how, isolated })).finally(server.end)
  }
}

async function developed(name, files, command, how = {}) {
  const server = await serveProgram(project(name, files), command)
  await opened(server.address, (page) => (how.see ?? works)(page, how)).catch((error) => {
    throw new Error(`${error.message}\n${server.said()}`)
  }).finally(server.end)
}

const VITE = { 'index.html': PAGE(MODULE), 'main.js': MAIN }
for (const [tool, program] of [['vite 8', 'vite#vite'], ['vite 7', 'vite7#vite']]) {
  const isFirst = tool === 'vite 8'
  add(tool, 'build', ['build', 'minified', ...EVERYTHING], () => built(`${tool} build`, VITE, [[program, 'build']], 'dist'), isFirst)
  add(tool, 'dev', ['dev', ...EVERYTHING], () =>
    developed(`${tool} dev`, VITE, [program, '--host', '127.0.0.1', '--port', 'PORT', '--strictPort']))
}

const WEBPACK = { 'main.js': MAIN, 'index.html': PAGE('<script src="/main.js"></script>') }
add('webpack 5', 'build', ['build', 'minified', ...EVERYTHING], () =>
  built('webpack build', WEBPACK, [['webpack#webpack', '--mode', 'production', '--entry', './main.js', '--output-path', 'dist']], 'dist',
    { page: '<script src="/main.js"></script>' }))
add('webpack 5', 'dev', ['dev', ...EVERYTHING], () =>
  developed('webpack dev', WEBPACK, ['webpack#webpack', 'serve', '--mode', 'development', '--entry', './main.js', '--port', 'PORT',
    '--host', '127.0.0.1', '--static', '.', '--output-public-path', '/']))

add('esbuild', 'build, inline', ['build', 'minified', ...EVERYTHING], () =>
  built('esbuild inline', { 'main.js': INLINE },
    [['esbuild#esbuild', 'main.js', '--bundle', '--minify', '--format=esm', '--outfile=dist/main.js', '--log-level=warning']], 'dist',
    { page: MODULE, inline: true }), true)
add('esbuild', 'build, files copied and setAssets', ['build', 'minified', ...EVERYTHING], () =>
  built('esbuild copied', { 'main.js': MAIN },
    [['esbuild#esbuild', 'main.js', '--bundle', '--minify', '--format=esm', '--outfile=dist/main.js', '--log-level=warning']], 'dist',
    { page: MODULE, hash: '#assets' }))

const ROLLUP = ['rollup#rollup', 'main.js', '-p', 'node-resolve', '-d', 'dist', '--silent']
add('rollup', 'build, inline', ['build', 'minified', ...EVERYTHING], () =>
  built('rollup inline', { 'main.js': INLINE }, [ROLLUP, ['esbuild#esbuild', 'dist/main.js', '--minify', '--allow-overwrite', '--outfile=dist/main.js']], 'dist',
    { page: MODULE, inline: true }))

const CLIENT = `import { createRoot } from 'react-dom/client'
import App from './react.jsx'
createRoot(document.body.appendChild(document.createElement('div'))).render(<App />)
`
const REACTS = { 'index.html': PAGE('<script type="module" src="/main.jsx"></script>'), 'main.jsx': CLIENT, 'react.jsx': REACT }
add('React 19 (vite 8)', 'build', ['build', 'minified', ...EVERYTHING], () =>
  built('react build', REACTS, [['vite#vite', 'build']], 'dist', { see: reacts }))
add('React 19 (vite 8)', 'dev', ['dev', ...EVERYTHING], () =>
  developed('react dev', REACTS, ['vite#vite', '--host', '127.0.0.1', '--port', 'PORT', '--strictPort'], { see: reacts }))

const NEXT = {
  'app/layout.jsx': `export default ({ children }) => <html lang="en"><head><link rel="icon" href="data:," /></head><body>{children}</body></html>`,
  'app/page.jsx': `'use client'\nimport { useEffect } from 'react'\nimport 'fixsplat/viewer'\nimport { load } from 'fixsplat'
globalThis.kept = load\nexport default () => { useEffect(() => { import('../main.js') }, []); return <p>splats</p> }`,
  'app/react/page.jsx': `'use client'\nexport { default } from '../../react.jsx'`,
  'main.js': MAIN,
  'react.jsx': REACT,
}
for (const [tool, flag] of [['Next.js (Turbopack)', '--turbopack'], ['Next.js (webpack)', '--webpack']]) {
  const both = async (server) => {
    try {
      await opened(server.address, works)
      await opened(`${server.address}react`, reacts)
    } catch (error) {
      throw new Error(`${error.message}\n${server.said()}`)
    } finally {
      await server.end()
    }
  }
  add(tool, 'build', ['build', 'minified', ...EVERYTHING], async () => {
    const folder = project(`${tool} build`, NEXT)
    assert.doesNotMatch(await build(folder, ['next#next', 'build', flag]), /fixsplat[^\n]*warn/i)
    isSmall(join(folder, '.next/static'))
    await both(await serveProgram(folder, ['next#next', 'start', '-p', 'PORT', '-H', '127.0.0.1']))
  })
  add(tool, 'dev', ['dev', ...EVERYTHING], async () =>
    both(await serveProgram(project(`${tool} dev`, NEXT), ['next#next', 'dev', flag, '-p', 'PORT', '-H', '127.0.0.1'])))
}

// It loses modules of a worker that are imported in two ways.
const PARCEL = { 'index.html': PAGE('<script type="module" src="./main.js"></script>'), 'main.js': INLINE }
add('parcel 2', 'build, inline', ['build', 'minified', ...EVERYTHING], () =>
  built('parcel build', PARCEL, [['parcel#parcel', 'build', 'index.html', '--no-cache']], 'dist', { inline: true }))
add('parcel 2', 'dev', ['dev', ...EVERYTHING], () =>
  developed('parcel dev', { ...PARCEL, 'main.js': MAIN }, ['parcel#parcel', 'serve', 'index.html', '--port', 'PORT', '--host', '127.0.0.1', '--no-cache']))

const FAR = { ...ISOLATED, 'access-control-allow-origin': '*', 'cross-origin-resource-policy': 'cross-origin' }
add('none, of another server', 'a line', EVERYTHING, async () => {
  const far = await serveFiles(home, FAR)
  const at = `${far.address}published`
  const folder = project('far', { 'index.html': PAGE(MODULE), 'main.js': mainOf(`${at}/fixsplat.js`, `${at}/viewer/viewer.js`) })
  await shows(folder).finally(far.end)
}, true)

const POLICY = "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self'; connect-src 'self'; img-src data:"
add('none, strict policy', 'a line', EVERYTHING, () => {
  const [load, viewer] = ['/published/fixsplat.js', '/published/viewer/viewer.js']
  return shows(project('near', { 'index.html': PAGE(MODULE), 'main.js': mainOf(load, viewer) }),
    { headers: { 'content-security-policy': POLICY } })
})

/** A bundle that nobody carried the files after says so, everywhere. */
add('esbuild', 'no files: words', [], async () => {
  const folder = project('esbuild bare', { 'main.js': MAIN, 'dist/index.html': PAGE(MODULE) })
  await build(folder, ['esbuild#esbuild', 'main.js', '--bundle', '--format=esm', '--outfile=dist/main.js', '--log-level=warning'])
  const server = await serveFiles(join(folder, 'dist'))
  const failing = opened(server.address, async (page) => {
    await until(page, () => globalThis.result && globalThis.said, 'nothing is said')
    const [{ error }, said] = await page.evaluate(() => [globalThis.result, globalThis.said])
    assert.match(error, /\.wasm: 404 Not Found.*README.*Bundlers/)
    assert.match(said, /script of the renderer cannot be loaded.*Bundlers/)
    const words = await page.evaluate(() => {
      const viewer = document.querySelector('fixsplat-viewer')
      viewer.removeAttribute('noui')
      const root = viewer.shadowRoot
      const { hidden, offsetHeight } = root.getElementById('error')
      return [hidden, offsetHeight > 0, root.getElementById('words').textContent]
    })
    assert.deepEqual(words, [false, true, said])
    throw new Error('said')
  }).finally(server.end)
  await assert.rejects(failing, /^Error: said\n[^]*worker_whole\.js/)
}, true)

const IN_NODE = `import assert from 'node:assert/strict'
import { load, end } from 'fixsplat'
import * as inline from 'fixsplat/inline'
import 'fixsplat/viewer'
import 'fixsplat/react'
import 'fixsplat/inline/viewer'
assert.equal(inline.load, load)
const scene = await load(process.argv[2], { threads: 2 })
for (let i = 0; i < 500 && scene.threads < 2; i++) await new Promise((done) => setTimeout(done, 10))
assert.equal(scene.threads, 2)
let h = 0xcbf29ce484222325n
for (const byte of scene.render({ eye: [2, -1, -4] }, { width: 64, height: 48 })) h = BigInt.asUintN(64, (h ^ BigInt(byte)) * 0x100000001b3n)
console.log(h.toString(16).padStart(16, '0'))
scene.free()
await end()
`
add('Node', 'import', ['worker', 'wasm'], async () => {
  const folder = project('node', { 'a.mjs': IN_NODE })
  const { stdout, stderr } = await run(process.execPath, ['a.mjs', resolve(work, 'scene.ply')], { cwd: folder })
  assert.deepEqual([stdout.trim(), stderr], [WANTED, ''])
}, true)

const report = async ({ tool, name, columns, run }) => {
  const start = performance.now()
  try {
    await run()
    console.log(`ok ${tool}: ${name} (${((performance.now() - start) / 1000).toFixed(1)} s)`)
    const row = columns.length ? (table[tool] ??= { types: process.env.TYPES }) : {}
    for (const column of columns) row[column] ??= 'yes'
  } catch (error) {
    console.log(`FAIL ${tool}: ${name}: ${error.message}`)
    for (const column of columns) (table[tool] ??= { types: process.env.TYPES })[column] = 'no'
    process.exitCode = 1
  }
}
for (const one of cases) if ((all || one.isQuick) && only.test(`${one.tool}: ${one.name}`)) await report(one)
await browser.close()

const COLUMNS = ['dev', 'build', 'minified', ...EVERYTHING, 'types']
const written = readFileSync('docs/web.md', 'utf8').split('\n')
const lines = [['tool', ...COLUMNS], ...Object.entries(table).map(([tool, row]) => [tool, ...COLUMNS.map((column) => row[column] ?? '')])]
  .map((cells) => `| ${cells.join(' | ')} |`)
console.log(lines.join('\n'))
const strange = all && !process.env.ONLY ? lines.filter((line) => !written.includes(line)) : []
console.log(strange.length ? `FAIL the table of docs/web.md has not:\n${strange.join('\n')}` : 'ok the table')
if (strange.length) process.exitCode = 1
