// node bundlers.mjs FIXSPLAT.tgz VIEWER.tgz WORK MODULES PUPPETEER COMMAND [all]: builds programs from the npm packages
// with the bundlers in MODULES. Each program runs in Chromium, in a cross-origin isolated page (with `all` also in
// others). Its pictures must equal the pictures of the command-line program COMMAND. The folder WORK has scene.ply.
import assert from 'node:assert/strict'
import { execFile, execFileSync } from 'node:child_process'
import { cpSync, mkdirSync, mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs'
import { createRequire } from 'node:module'
import { dirname, join, resolve } from 'node:path'
import { fileURLToPath } from 'node:url'
import { promisify } from 'node:util'
import { ISOLATED, pause, serveFiles, serveProgram } from './bundlers/servers.mjs'
import { WEBGL } from './flags.mjs'

const [tarball, viewerTarball, work, modules, puppeteers, command, all] = process.argv.slice(2)
const puppeteer = createRequire(resolve(puppeteers, 'of'))('puppeteer-core')
const scene = resolve(work, 'scene.ply')
const only = new RegExp(process.env.ONLY ?? '')
const run = promisify(execFile)
const textOf = (path) => readFileSync(fileURLToPath(new URL(path, import.meta.url)), 'utf8')

const home = mkdtempSync(join(dirname(resolve(modules)), 'try-'))
process.on('exit', () => rmSync(home, { recursive: true, force: true }))
for (const signal of ['SIGINT', 'SIGTERM']) process.on(signal, () => process.exit(1))

const rendered = (...options) =>
  execFileSync(command, ['render', scene, '--hash', ...options], { encoding: 'utf8' }).trim().split(/\s/)[0]
const VIEW = '--size 320x200 --bg 0e1116 --eye 0.3,-0.9,-4 --look 0,0,0 --up 0,-1,0 --fov'.split(' ')
const WANTED = rendered('--size', '64x48', '--eye', '2,-1,-4')
const WANTED_VIEW = rendered(...VIEW, '45')
const WANTED_WIDER = rendered(...VIEW, '60')

const installed = (() => {
  const folder = join(home, 'installed')
  mkdirSync(folder)
  writeFileSync(join(folder, 'package.json'), '{ "private": true }')
  const quietly = ['--offline', '--ignore-scripts', '--no-audit', '--no-fund', '--loglevel=error']
  const tarballs = [tarball, viewerTarball].map((file) => resolve(file))
  execFileSync('npm', ['install', ...quietly, ...tarballs], { cwd: folder, stdio: 'pipe' })
  return join(folder, 'node_modules')
})()
const NAMES = ['fixsplat', 'fixsplat-viewer']
const { version } = JSON.parse(readFileSync(join(installed, 'fixsplat/package.json'), 'utf8'))

// Copies the packages' files to a server as README.md of fixsplat-viewer says, and as a content delivery network has
// them.
const published = join(home, 'published')
cpSync(join(installed, 'fixsplat'), published, { recursive: true })
cpSync(join(installed, 'fixsplat-viewer/page'), join(published, 'viewer'), { recursive: true })
const cdn = join(home, 'cdn')
for (const name of NAMES) cpSync(join(installed, name), join(cdn, `${name}@${version}`), { recursive: true })

function project(name, files) {
  const folder = join(home, name.replace(/\W+/g, '_'))
  const texts = { 'package.json': '{ "private": true, "type": "module" }', ...files }
  for (const [path, text] of Object.entries(texts)) {
    mkdirSync(dirname(join(folder, path)), { recursive: true })
    writeFileSync(join(folder, path), text)
  }
  for (const name of NAMES) cpSync(join(installed, name), join(folder, 'node_modules', name), { recursive: true })
  return folder
}

const environment = { ...process.env, NEXT_TELEMETRY_DISABLED: '1', NO_COLOR: '1', CI: '1' }
delete environment.NODE_ENV

function wordsOf(line) {
  const [program, ...rest] = line.split(' ')
  const [name, key] = program.split('#')
  const { bin } = JSON.parse(readFileSync(join(modules, name, 'package.json'), 'utf8'))
  return [resolve(modules, name, typeof bin === 'string' ? bin : bin[key]), ...rest]
}

async function build(folder, line) {
  const how = { cwd: folder, env: environment, maxBuffer: 1e8 }
  const { stdout, stderr } = await run(process.execPath, wordsOf(line), how).catch((error) => {
    throw new Error(`${line}: ${error.stdout}${error.stderr}`)
  })
  return stdout + stderr
}

function isMinified(folder) {
  const scripts = readdirSync(folder, { recursive: true }).filter((name) => /\.m?js$/.test(name))
  assert.ok(scripts.length > 0)
  for (const name of scripts) assert.doesNotMatch(readFileSync(join(folder, name), 'utf8'), /sharedMemory/, name)
}

const browser = await puppeteer.launch({
  executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
  args: ['--no-sandbox', ...WEBGL],
})

async function opened(address, see) {
  const page = await browser.newPage()
  const faults = []
  page.on('pageerror', (error) => faults.push(error.message))
  page.on('console', (line) => line.type() === 'error' && faults.push(line.text()))
  page.on('response', (answer) => answer.status() >= 400 && faults.push(`${answer.status()} ${answer.url()}`))
  page.on('requestfailed', (asked) => {
    const why = asked.failure()?.errorText
    if (!/ERR_ABORTED/.test(why)) faults.push(`${why} ${asked.url()}`)
  })
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

async function until(page, is, words) {
  const state = () =>
    JSON.stringify([globalThis.result, globalThis.said, document.querySelector('fixsplat-viewer')?.outerHTML])
  await page.waitForFunction(is, { timeout: 120000, polling: 50 }).catch(async () => {
    throw new Error(`${words}: ${await page.evaluate(state)}`)
  })
}

async function shown(page) {
  const rests = () => document.querySelector('fixsplat-viewer')?.getAttribute('state') === 'still'
  await until(page, rests, 'the element does not come to rest')
  await pause(250)
  return page.evaluate(async () => {
    const { shadowRoot } = document.querySelector('fixsplat-viewer')
    const seen = await createImageBitmap(shadowRoot.getElementById('stage').lastElementChild)
    const copy = new OffscreenCanvas(seen.width, seen.height).getContext('2d')
    copy.drawImage(seen, 0, 0)
    let h = 0xcbf29ce484222325n
    for (const byte of copy.getImageData(0, 0, seen.width, seen.height).data)
      h = BigInt.asUintN(64, (h ^ BigInt(byte)) * 0x100000001b3n)
    return h.toString(16).padStart(16, '0')
  })
}

async function works(page, { isolated = true, inline = false } = {}) {
  await until(page, () => globalThis.result, 'the program does not end')
  const threads = isolated ? 2 : 1
  const one = { threads: 1, hash: WANTED }
  const { error, threaded, single, plain, webgl } = await page.evaluate(() => globalThis.result)
  assert.equal(error, undefined)
  assert.equal(await page.evaluate(() => crossOriginIsolated), isolated)
  assert.deepEqual([threaded, single, webgl], [{ threads, hash: WANTED }, one, WANTED])
  if (inline) assert.match(plain, /core\.wasm: is no part of fixsplat\/inline/)
  else assert.deepEqual(plain, one)
  assert.equal(await shown(page), WANTED_VIEW, 'the element shows another picture')
  assert.equal(page.workers().length, isolated ? 3 : 1, 'workers')
  await page.evaluate(() => document.querySelector('fixsplat-viewer').setAttribute('backend', 'webgl2'))
  await until(page, () => document.querySelector('fixsplat-viewer').backend === 'webgl2', 'no WebGL 2 in the worker')
  assert.equal(await shown(page), WANTED_VIEW, 'the element shows another picture by WebGL 2')
  assert.equal(await page.evaluate(() => globalThis.said), undefined)
}

async function reacts(page) {
  assert.equal(await shown(page), WANTED_VIEW)
  await page.click('#wider')
  await pause(600)
  assert.equal(await shown(page), WANTED_WIDER)
  await page.click('#shown')
  await until(page, () => !document.querySelector('fixsplat-viewer'), 'the element stays')
  for (let i = 0; i < 1200 && page.workers().length; i++) await pause(100)
  assert.equal(page.workers().length, 0, 'its workers stay')
  await page.click('#shown')
  assert.equal(await shown(page), WANTED_WIDER)
}

const EVERYTHING = ['worker', 'wasm', 'element']
const BUILD = ['build', 'minified', ...EVERYTHING]
const DEV = ['dev', ...EVERYTHING]
const cases = []
const add = (tool, name, columns, run, isQuick = false) => cases.push({ tool, name, columns, run, isQuick })

const pageOf = (scripts) =>
  `<!doctype html><meta charset="utf-8"><title>x</title><link rel="icon" href="data:,"><body>${scripts}</body>`
const MODULE = '<script type="module" src="/main.js"></script>'
const mainOf = (load, viewer) => textOf('./bundlers/main.js').replace('@LOAD@', load).replace('@VIEWER@', viewer)
const MAIN = mainOf('fixsplat', 'fixsplat-viewer')
const INLINE = mainOf('fixsplat/inline', 'fixsplat-viewer/inline')
const REACT = textOf('../../docs/examples/react.tsx')

const served = (folder, headers) =>
  serveFiles(folder, { '/scene.ply': scene, '/published/': published, '/cdn/': cdn }, headers)
const started = (folder, line) => serveProgram(folder, wordsOf(line), environment, { '/scene.ply': scene })

async function shows(folder, how = {}) {
  for (const isolated of all ? [true, false] : [true]) {
    const server = await served(folder, { ...(isolated ? ISOLATED : {}), ...how.headers })
    const see = (page) => (how.see ?? works)(page, { ...how, isolated })
    await opened(server.address + (how.hash ?? ''), see).finally(server.end)
  }
}

const SIZES = /WARNING in (asset|entrypoint) size limit|compiled with \d warnings?/g

async function built(name, files, lines, how = {}) {
  const folder = project(name, files)
  for (const line of lines) {
    const said = await build(folder, line)
    assert.doesNotMatch(said.replace(SIZES, ''), /\bwarn(ing)?\b/i, said)
  }
  const dist = join(folder, 'dist')
  if (how.page) writeFileSync(join(dist, 'index.html'), pageOf(how.page))
  isMinified(dist)
  await shows(dist, how)
}

async function servedBy(folder, line, pages) {
  const server = await started(folder, line)
  try {
    for (const [path, see] of Object.entries(pages)) await opened(server.address + path, (page) => see(page))
  } catch (error) {
    throw new Error(`${error.message}\n${server.said()}`)
  } finally {
    await server.end()
  }
}

const VITE = { 'index.html': pageOf(MODULE), 'main.js': MAIN }
const AT_PORT = '--host 127.0.0.1 --port PORT'
for (const [tool, vite, isQuick] of [['vite 8', 'vite#vite', true], ['vite 7', 'vite7#vite', false]]) {
  add(tool, 'build', BUILD, () => built(`${tool} build`, VITE, [`${vite} build`]), isQuick)
  add(tool, 'dev', DEV, () =>
    servedBy(project(`${tool} dev`, VITE), `${vite} ${AT_PORT} --strictPort`, { '': works }))
}

const SCRIPT = '<script src="/main.js"></script>'
const WEBPACK = { 'main.js': MAIN, 'index.html': pageOf(SCRIPT) }
const FROM = '--entry ./main.js'
add('webpack 5', 'build', BUILD, () =>
  built('webpack build', WEBPACK, [`webpack#webpack --mode production ${FROM} --output-path dist`], { page: SCRIPT }))
add('webpack 5', 'dev', DEV, () => {
  const line = `webpack#webpack serve --mode development ${FROM} ${AT_PORT} --static . --output-public-path /`
  return servedBy(project('webpack dev', WEBPACK), line, { '': works })
})

const ESBUILD = 'esbuild#esbuild main.js --bundle --minify --format=esm --outfile=dist/main.js --log-level=warning'
add('esbuild', 'build, inline', BUILD, () =>
  built('esbuild inline', { 'main.js': INLINE }, [ESBUILD], { page: MODULE, inline: true }), true)
add('esbuild', 'build, files copied and setAssets', BUILD, () =>
  built('esbuild copied', { 'main.js': MAIN }, [ESBUILD], { page: MODULE, hash: '#assets' }))

add('rollup', 'build, inline', BUILD, () => {
  const minify = 'esbuild#esbuild dist/main.js --minify --allow-overwrite --outfile=dist/main.js --log-level=warning'
  const lines = ['rollup#rollup main.js -p node-resolve -d dist --silent', minify]
  return built('rollup inline', { 'main.js': INLINE }, lines, { page: MODULE, inline: true })
})

const REACTS = {
  'index.html': pageOf('<script type="module" src="/main.jsx"></script>'),
  'main.jsx': `import { createRoot } from 'react-dom/client'
    import App from './react.tsx'
    createRoot(document.body.appendChild(document.createElement('div'))).render(<App />)`,
  'react.tsx': REACT,
}
add('React 19 (vite 8)', 'build', BUILD, () => built('react build', REACTS, ['vite#vite build'], { see: reacts }))
add('React 19 (vite 8)', 'dev', DEV, () =>
  servedBy(project('react dev', REACTS), `vite#vite ${AT_PORT} --strictPort`, { '': reacts }))

const NEXT = {
  'app/layout.jsx': `export default ({ children }) => (
    <html lang="en"><head><link rel="icon" href="data:," /></head><body>{children}</body></html>)`,
  'app/page.jsx': `'use client'
    import { useEffect } from 'react'
    import { load } from 'fixsplat'
    import 'fixsplat-viewer'
    globalThis.kept = load
    export default () => {
      useEffect(() => { import('../main.js') }, [])
      return <p>splats</p>
    }`,
  'app/react/page.jsx': `'use client'
    export { default } from '../../react.jsx'`,
  'main.js': MAIN,
  'react.jsx': createRequire(resolve(modules, 'of'))('esbuild')
    .transformSync(REACT, { loader: 'tsx', jsx: 'preserve' }).code,
}
for (const [tool, flag] of [['Next.js (Turbopack)', '--turbopack'], ['Next.js (webpack)', '--webpack']]) {
  const pages = { '': works, react: reacts }
  const at = '-H 127.0.0.1 -p PORT'
  add(tool, 'build', BUILD, async () => {
    const folder = project(`${tool} build`, NEXT)
    assert.doesNotMatch(await build(folder, `next#next build ${flag}`), /fixsplat[^\n]*warn/i)
    isMinified(join(folder, '.next/static'))
    await servedBy(folder, `next#next start ${at}`, pages)
  })
  add(tool, 'dev', DEV, () => servedBy(project(`${tool} dev`, NEXT), `next#next dev ${flag} ${at}`, pages))
}

const PARCEL = { 'index.html': pageOf(MODULE.replace('/main', './main')), 'main.js': INLINE }
add('parcel 2', 'build, inline', BUILD, () =>
  built('parcel build', PARCEL, ['parcel#parcel build index.html --no-cache'], { inline: true }))
add('parcel 2', 'dev', DEV, () => {
  const folder = project('parcel dev', { ...PARCEL, 'main.js': MAIN })
  return servedBy(folder, `parcel#parcel serve index.html --no-cache ${AT_PORT}`, { '': works })
})

const OF_OTHERS = {
  ...ISOLATED,
  'access-control-allow-origin': '*',
  'cross-origin-resource-policy': 'cross-origin',
}
add('none, of another server', 'a line', EVERYTHING, async () => {
  const far = await served(home, OF_OTHERS)
  const files = ['fixsplat/fixsplat.js', 'fixsplat-viewer/page/viewer.js']
  const [load, viewer] = files.map((name) => `${far.address}cdn/${name.replace('/', `@${version}/`)}`)
  const page = pageOf(`<script type="module" src="${viewer}"></script>${MODULE}`)
  await shows(project('far', { 'index.html': page, 'main.js': mainOf(load, viewer) })).finally(far.end)
}, true)

// The files of a program are on another server than its page, as on a content delivery network.
const FAR_BUILDS = {
  'vite 8': [VITE, 'vite#vite build --base FAR', (folder) => readFileSync(join(folder, 'index.html'), 'utf8')],
  'webpack 5': [WEBPACK, `webpack#webpack --mode production ${FROM} --output-path dist --output-public-path FAR`,
    (_, far) => pageOf(`<script crossorigin src="${far}main.js"></script>`)],
}
for (const [tool, [files, line, pageAt]] of Object.entries(FAR_BUILDS))
  add(tool, 'build, of another server', [], async () => {
    const folder = project(`${tool} far`, files)
    const far = await served(join(folder, 'dist'), OF_OTHERS)
    try {
      await build(folder, line.replace('FAR', far.address))
      await shows(project(`${tool} near`, { 'index.html': pageAt(join(folder, 'dist'), far.address) }))
    } finally {
      far.end()
    }
  }, tool === 'vite 8')

const POLICY =
  "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self'; connect-src 'self'; img-src data:"
add('none, strict policy', 'a line', EVERYTHING, () => {
  const main = mainOf('/published/fixsplat.js', '/published/viewer/viewer.js')
  const folder = project('near', { 'index.html': pageOf(MODULE), 'main.js': main })
  return shows(folder, { headers: { 'content-security-policy': POLICY } })
})

async function saysWhatIsMissing(page) {
  await until(page, () => globalThis.result && globalThis.said, 'nothing is said')
  const [{ error }, said] = await page.evaluate(() => [globalThis.result, globalThis.said])
  assert.match(error, /\.wasm: 404 Not Found.*README.*Bundlers/)
  assert.match(said, /script of the renderer cannot be loaded.*Bundlers/)
  const words = await page.evaluate(() => {
    const viewer = document.querySelector('fixsplat-viewer')
    viewer.removeAttribute('noui')
    const box = viewer.shadowRoot.getElementById('error')
    return [box.offsetHeight > 0, viewer.shadowRoot.getElementById('words').textContent]
  })
  assert.deepEqual(words, [true, said])
  throw new Error('all is said')
}
add('esbuild', 'no files: words', [], async () => {
  const folder = project('esbuild bare', { 'main.js': MAIN, 'dist/index.html': pageOf(MODULE) })
  await build(folder, ESBUILD)
  const server = await served(join(folder, 'dist'))
  await assert.rejects(opened(server.address, saysWhatIsMissing), /^Error: all is said\n[^]*worker_whole\.js/)
    .finally(server.end)
}, true)

const IN_NODE = `import assert from 'node:assert/strict'
import { load, end } from 'fixsplat'
import * as inline from 'fixsplat/inline'
import 'fixsplat-viewer'
import 'fixsplat-viewer/react'
import 'fixsplat-viewer/inline'
assert.equal(inline.load, load)
const scene = await load(process.argv[2], { threads: 2 })
for (let i = 0; i < 500 && scene.threads < 2; i++) await new Promise((done) => setTimeout(done, 10))
assert.equal(scene.threads, 2)
let h = 0xcbf29ce484222325n
for (const byte of scene.render({ eye: [2, -1, -4] }, { width: 64, height: 48 }))
  h = BigInt.asUintN(64, (h ^ BigInt(byte)) * 0x100000001b3n)
console.log(h.toString(16).padStart(16, '0'))
scene.free()
await end()
`
add('Node', 'import', ['worker', 'wasm'], async () => {
  const cwd = project('node', { 'a.mjs': IN_NODE })
  const { stdout, stderr } = await run(process.execPath, ['a.mjs', scene], { cwd })
  assert.deepEqual([stdout.trim(), stderr], [WANTED, ''])
}, true)

const table = {}

async function report({ tool, name, columns, run }) {
  const row = columns.length ? (table[tool] ??= { types: process.env.TYPES }) : {}
  const start = performance.now()
  try {
    await run()
    console.log(`ok ${tool}: ${name} (${((performance.now() - start) / 1000).toFixed(1)} s)`)
    for (const column of columns) row[column] ??= 'yes'
  } catch (error) {
    console.log(`FAIL ${tool}: ${name}: ${error.message}`)
    for (const column of columns) row[column] = 'no'
    process.exitCode = 1
  }
}
for (const one of cases) if ((all || one.isQuick) && only.test(`${one.tool}: ${one.name}`)) await report(one)
await browser.close()

const COLUMNS = ['dev', 'build', 'minified', ...EVERYTHING, 'types']
const rows = Object.entries(table).map(([tool, row]) => [tool, ...COLUMNS.map((column) => row[column] ?? '')])
const lines = [['tool', ...COLUMNS], ...rows].map((cells) => `| ${cells.join(' | ')} |`)
console.log(lines.join('\n'))
