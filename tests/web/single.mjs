// node single.mjs FILE MODULES PICTURES FIXSPLAT SCENE: checks that FILE, a page that `fixsplat publish --single`
// wrote, works from a file:// address.
import assert from 'node:assert/strict'
import { execFileSync } from 'node:child_process'
import { createRequire } from 'node:module'
import { resolve } from 'node:path'
import { pathToFileURL } from 'node:url'

const [file, modules, pictures, fixsplat, scene] = process.argv.slice(2)
const puppeteer = createRequire(resolve(modules, 'of'))('puppeteer-core')
const browser = await puppeteer.launch({ executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium', args: ['--no-sandbox'] })
const page = await browser.newPage()
const own = pathToFileURL(resolve(file)).href
const asked = []
const faults = []
page.on('request', (request) => /^(data|blob):/.test(request.url()) || asked.push(request.url()))
page.on('pageerror', (error) => faults.push(error.message))
page.on('console', (said) => said.type() === 'error' && faults.push(said.text()))
try {
  await page.setViewport({ width: 640, height: 360 })
  await page.setOfflineMode(true)
  await page.goto(own)
  await page.waitForSelector('fixsplat-viewer[state=still][open]', { timeout: 60000 })
  const { view, title, hash } = await page.evaluate(async () => {
    const viewer = document.querySelector('fixsplat-viewer')
    const $ = (id) => viewer.shadowRoot.getElementById(id)
    await new Promise((done) => setTimeout(done, 250))
    const seen = await createImageBitmap($('stage').lastElementChild)
    const copy = new OffscreenCanvas(seen.width, seen.height).getContext('2d')
    copy.drawImage(seen, 0, 0)
    let h = 0xcbf29ce484222325n
    for (const b of copy.getImageData(0, 0, seen.width, seen.height).data)
      h = BigInt.asUintN(64, (h ^ BigInt(b)) * 0x100000001b3n)
    return { view: viewer.view, title: $('name').textContent, hash: h.toString(16).padStart(16, '0') }
  })
  await page.screenshot({ path: `${pictures}/single.png` })
  assert.equal(title, 'A knot', 'its title')
  const n = view.split(',')
  const camera = ['--eye', n.slice(0, 3).join(), '--look', n.slice(3, 6).join(), '--up', n.slice(6, 9).join(), '--fov', n[9]]
  const words = ['render', scene, '--hash', ...camera, '--size', '640x360', '--bg', '000000']
  assert.equal(hash, execFileSync(fixsplat, words, { encoding: 'utf8' }).split(/\s/)[0], "the command's picture")
  assert.deepEqual(asked, [own], 'it asks for nothing')
  assert.deepEqual(faults, [], 'not a fault')
  console.log('ok one file, by file:// and offline')
} catch (error) {
  console.log(`FAIL one file: ${error.message}`, faults, asked)
  process.exitCode = 1
}
await browser.close()
