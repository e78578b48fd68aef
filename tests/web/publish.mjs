// node publish.mjs SITE MODULES PICTURES SCENE...: checks the web pages that `fixsplat publish` wrote to the folder
// SITE, on a plain file server.
import assert from 'node:assert/strict'
import { existsSync, readFileSync } from 'node:fs'
import { createServer } from 'node:http'
import { createRequire } from 'node:module'
import { resolve } from 'node:path'
import { POLICY } from './policy.mjs'

const [site, modules, pictures, ...names] = process.argv.slice(2)
const puppeteer = createRequire(resolve(modules, 'of'))('puppeteer-core')
const KINDS = { js: 'text/javascript', html: 'text/html', css: 'text/css', wasm: 'application/wasm', jpg: 'image/jpeg' }
const lost = []
let isHeld = () => false
const server = createServer((request, response) => {
  if (isHeld(request.url)) return
  const file = site + new URL(request.url, 'http://x').pathname.replace(/\/$/, '/index.html')
  if (!existsSync(file)) return lost.push(file), response.writeHead(404).end()
  response.setHeader('content-security-policy', POLICY)
  response.setHeader('content-type', KINDS[file.split('.').pop()] ?? 'application/octet-stream')
  response.end(readFileSync(file))
}).listen(0, '127.0.0.1')
await new Promise((done) => server.once('listening', done))
const browser = await puppeteer.launch({ executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium', args: ['--no-sandbox'] })
const page = await browser.newPage()
const refused = []
page.on('console', (message) => /Content Security Policy/i.test(message.text()) && refused.push(message.text()))
const open = (name) => page.goto(`http://127.0.0.1:${server.address().port}/${name}`, { waitUntil: 'load' })
const keep = (name) => page.screenshot({ path: `${pictures}/published-${name}.png` })
try {
  await open('')
  if (names.length > 1) {
    const loaded = () => [...document.images].every((image) => image.naturalWidth)
    await page.waitForFunction(loaded, { timeout: 10000 }).catch(() => {})
    const widths = await page.$$eval('img', (all) => all.map((image) => image.naturalWidth))
    assert.deepEqual(widths, names.map(() => 640), 'a picture for each scene')
    console.log('ok the list')
    await keep('list')
  }
  const of = (body) => page.evaluate(`(() => { const v = document.querySelector('fixsplat-viewer')
    const $ = (id) => v.shadowRoot.getElementById(id), shown = (e) => e.checkVisibility(); ${body} })()`)
  const still = () => page.waitForFunction(() => document.querySelector('fixsplat-viewer').state === 'still', { timeout: 60000 })
  const tangent = async () => Math.tan((await of('return v.camera.fov')) * Math.PI / 360)
  const first = names.length > 1 ? `${names[0]}.html` : ''
  const tangents = []
  for (const [width, height] of [[1280, 720], [390, 844]]) {
    await page.setViewport({ width, height })
    isHeld = (url) => url.endsWith('.fxs')
    await open(first)
    await page.waitForFunction(() => document.querySelector('fixsplat-viewer').shadowRoot?.querySelector('#stage > img')?.naturalWidth)
    const seen = await of(`return [v.state, shown($('empty')), shown(v.shadowRoot.querySelector('.bar')),
      $('loading').offsetHeight, $('stage').querySelector('img').offsetHeight]`)
    const poster = seen.pop()
    assert.deepEqual(seen, ['loading', false, false, 3], 'poster and progress alone')
    isHeld = () => false
    await open(first)
    await still()
    tangents.push(await tangent())
    assert.ok(Math.abs(poster / height - tangents[0] / tangents.at(-1)) < 0.004, `poster ${poster} of ${height}`)
  }
  await page.setViewport({ width: 800, height: 600 })
  console.log('ok while loading, the poster has the place of the first picture')
  for (const name of names) {
    await open(names.length > 1 ? `${name}.html` : '')
    await page.waitForFunction(() => document.querySelector('fixsplat-viewer').state === 'still', { timeout: 60000 })
    if (existsSync(`${site}/settings.json`))
      await page.waitForFunction(() => document.querySelector('fixsplat-viewer').annotations[0]?.title === 'Middle')
    await keep(name)
    console.log(`ok ${name} is shown`)
    const here = page.url().replace(/#.*/, '')
    const [link, focused] = await page.evaluate(() => {
      const viewer = document.querySelector('fixsplat-viewer')
      return [viewer.link, document.activeElement === viewer]
    })
    assert.ok(link.startsWith(`${here}#view=`) && focused, `${link}, focused: ${focused}`)
    await page.goto(`${here}#view=1,-2,-9,0,0,0,0,-1,0,40`)
    const followed = () => document.querySelector('fixsplat-viewer').camera?.eye.join() === '1,-2,-9'
    await page.waitForFunction(followed, { timeout: 30000 })
    console.log(`ok ${name} follows links to it`)
  }
  assert.deepEqual(lost, [], 'every file is there')
  assert.deepEqual(refused, [], 'the policy allows all of it')
} catch (error) {
  console.log(`FAIL published pages: ${error.message}`)
  process.exitCode = 1
}
await browser.close()
server.close()
