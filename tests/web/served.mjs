// node served.mjs FIXSPLAT FOLDER MODULES PICTURES: checks the web pages that `fixsplat view --web FOLDER` serves.
import assert from 'node:assert/strict'
import { execFileSync, spawn } from 'node:child_process'
import { renameSync, rmSync, writeFileSync } from 'node:fs'
import { createRequire } from 'node:module'
import { resolve } from 'node:path'

const [fixsplat, folder, modules, pictures] = process.argv.slice(2)
const puppeteer = createRequire(resolve(modules, 'of'))('puppeteer-core')
const server = spawn(fixsplat, ['view', '--web', '--port', '0', folder], { stdio: ['ignore', 'pipe', 'ignore'] })
const address = await new Promise((done) => server.stdout.once('data', (text) => done(`${text}`.trim())))
const browser = await puppeteer.launch({ executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium', args: ['--no-sandbox'] })
const page = await browser.newPage()
const faults = []
page.on('pageerror', (error) => faults.push(error.message))
const until = (body) => page.waitForFunction(body, { timeout: 60000, polling: 100 })
const still = () => page.waitForSelector('fixsplat-viewer[state=still][open]', { timeout: 60000 })
const told = (words) => until(`document.getElementById('told').textContent.includes(${JSON.stringify(words)})`)
const count = (splats) => until(`document.querySelector('fixsplat-viewer').shadowRoot.getElementById('count').textContent === '${splats} splats'`)
const make = (kind, many, to) => execFileSync(fixsplat, ['make-scene', kind, '--count', many, '-o', to])
const viewOf = () => page.$eval('fixsplat-viewer', (viewer) => viewer.view)

async function compare(scene) {
  await still()
  await new Promise((done) => setTimeout(done, 400))
  await still()
  const { hash, view } = await page.evaluate(async () => {
    const viewer = document.querySelector('fixsplat-viewer')
    const seen = await createImageBitmap(viewer.shadowRoot.getElementById('stage').lastElementChild)
    const copy = new OffscreenCanvas(seen.width, seen.height).getContext('2d')
    copy.drawImage(seen, 0, 0)
    let h = 0xcbf29ce484222325n
    for (const b of copy.getImageData(0, 0, seen.width, seen.height).data)
      h = BigInt.asUintN(64, (h ^ BigInt(b)) * 0x100000001b3n)
    return { hash: h.toString(16).padStart(16, '0'), view: viewer.view }
  })
  const n = view.split(',')
  const camera = ['--eye', n.slice(0, 3).join(), '--look', n.slice(3, 6).join(), '--up', n.slice(6, 9).join(), '--fov', n[9]]
  const words = ['render', scene, '--hash', ...camera, '--size', '640x360', '--bg', '0e1116']
  assert.equal(hash, execFileSync(fixsplat, words, { encoding: 'utf8' }).split(/\s/)[0], "the command's picture")
}

async function test(name, run) {
  await run()
  assert.deepEqual(faults, [])
  console.log(`ok served: ${name}`)
}

try {
  await page.emulateMediaFeatures([{ name: 'prefers-color-scheme', value: 'dark' }])
  await page.setViewport({ width: 640, height: 360 })
  await page.goto(address)
  await test('the list', async () => {
    await until(`[...document.images].filter((image) => image.naturalWidth === 640).length === 1`)
    await until(`/bad.ply.*asks for/s.test(document.querySelector('main').innerText)`)
    await page.screenshot({ path: `${pictures}/served-list.png` })
  })
  await test('the list in Chinese', async () => {
    await page.goto(`${address}list.html?lang=zh`)
    await until(`document.querySelector('h1').textContent === '场景' && document.documentElement.lang === 'zh'`)
    await page.goto(address)
  })
  const knot = `${folder}/knot.ply`
  await test('a scene', async () => {
    await page.click('main a:last-of-type')
    await still()
    await count('2,000')
    const named = `document.querySelector('fixsplat-viewer').shadowRoot.getElementById('name').textContent`
    assert.equal(await page.evaluate(named), 'knot.ply')
    await compare(knot)
  })
  let view
  await test('its file changes: the new one, by the same camera', async () => {
    await page.focus('fixsplat-viewer')
    await page.keyboard.press('ArrowRight', { delay: 300 })
    await still()
    await new Promise((done) => setTimeout(done, 500))
    view = await viewOf()
    make('cubes', 1000, `${folder}/next.tmp.ply`)
    renameSync(`${folder}/next.tmp.ply`, knot)
    await count('1,000')
    await compare(knot)
    assert.equal(await viewOf(), view)
  })
  await test('garbage: said, and what was there stays', async () => {
    execFileSync('cp', [knot, `${folder}/kept.tmp`])
    writeFileSync(knot, 'no scene')
    await told('knot.ply: not a scene file')
    await page.screenshot({ path: `${pictures}/served-garbage.png` })
    await compare(`${folder}/kept.tmp`)
    rmSync(knot)
    await told('knot.ply: the file is not there any more')
  })
  await test('a reload meanwhile: what was there', async () => {
    await page.reload()
    await still()
    await count('1,000')
    await told('the file is not there any more')
  })
  await test('the same in German', async () => {
    const english = page.url()
    await page.goto(english.replace('&', '?').replace('?scene', '?lang=de&scene'))
    await still()
    await told('knot.ply: die Datei ist nicht mehr da. Das hier ist, was vorher da war')
    await page.goto(english)
  })
  await test('it is there again', async () => {
    renameSync(`${folder}/kept.tmp`, knot)
    await until(`document.getElementById('told').hidden`)
    await compare(knot)
  })
  await test('the server ends: said', async () => {
    server.kill()
    await told('The server does not answer')
  })
} catch (error) {
  console.log(`FAIL served pages: ${error.stack}`)
  await page.screenshot({ path: `${pictures}/served-failed.png` })
  process.exitCode = 1
}
await browser.close()
server.kill()
