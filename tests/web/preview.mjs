// node preview.mjs FIXSPLAT SET MODULES PICTURES: checks the web page on which `fixsplat fit SET --preview` shows a
// running fit.
import assert from 'node:assert/strict'
import { execFileSync, spawn } from 'node:child_process'
import { once } from 'node:events'
import { createRequire } from 'node:module'
import { dirname, resolve } from 'node:path'
import { WEBGL } from './flags.mjs'

const [fixsplat, set, modules, pictures] = process.argv.slice(2)
const puppeteer = createRequire(resolve(modules, 'of'))('puppeteer-core')
const folder = dirname(set)
const browser = await puppeteer.launch({ executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
  args: ['--no-sandbox', ...WEBGL] })
const page = await browser.newPage()
const faults = []
page.on('pageerror', (error) => faults.push(error.message))
await page.emulateMediaFeatures([{ name: 'prefers-color-scheme', value: 'dark' }])
const fits = []

async function begin(port, ...options) {
  const { FIXSPLAT_QUIET, ...env } = process.env
  const words = ['fit', set, '-o', 'page.fxs', '--preview', '--port', port, ...options]
  const fit = spawn(fixsplat, words, { cwd: folder, env, stdio: ['ignore', 'ignore', 'pipe'] })
  fits.push(fit)
  let said = ''
  for await (const part of fit.stderr.iterator({ destroyOnReturn: false })) {
    said += part
    const address = said.match(/preview: (http:\S+)\n/)
    if (!address) continue
    fit.stderr.on('data', (more) => (said += more))
    return { fit, address: address[1], said: () => said, exit: once(fit, 'exit') }
  }
  throw new Error(said)
}

const inside = (body) =>
  page.evaluate(`(async () => { const v = document.querySelector('fixsplat-viewer'), $ = (id) => document.getElementById(id);
    ${body} })()`)
const until = (body) =>
  page.waitForFunction(`(() => { const v = document.querySelector('fixsplat-viewer'), $ = (id) => document.getElementById(id);
    ${body} })()`, { timeout: 120000, polling: 100 })
const still = () => page.waitForSelector('fixsplat-viewer[state=still]', { timeout: 120000 })
const pause = (ms) => new Promise((done) => setTimeout(done, ms))

async function shown() {
  await still()
  await pause(250)
  return inside(`const seen = await createImageBitmap(v.shadowRoot.getElementById('stage').lastElementChild);
    const copy = new OffscreenCanvas(seen.width, seen.height).getContext('2d');
    copy.drawImage(seen, 0, 0);
    const { data } = copy.getImageData(0, 0, seen.width, seen.height);
    let h = 0xcbf29ce484222325n;
    for (const b of data) h = BigInt.asUintN(64, (h ^ BigInt(b)) * 0x100000001b3n);
    return { hash: h.toString(16).padStart(16, '0'), colours: new Set(new Uint32Array(data.buffer)).size,
      size: [seen.width, seen.height].join('x') }`)
}

function rendered(scene, view, size) {
  const n = view.split(',')
  const camera = ['--eye', n.slice(0, 3).join(), '--look', n.slice(3, 6).join(), '--up', n.slice(6, 9).join()]
  const words = ['render', `${folder}/${scene}`, '--hash', ...camera, '--fov', n[9], '--size', size, '--bg', '000000']
  return execFileSync(fixsplat, words, { encoding: 'utf8' }).split(/\s/)[0]
}

async function test(name, run) {
  faults.length = 0
  await run()
  assert.deepEqual(faults, [])
  console.log(`ok page: ${name}`)
}

try {
  const long = await begin('0', '--steps', '40000')
  const port = new URL(long.address).port
  let view

  await test('the scene is shown, from the first photograph held out', async () => {
    await page.setViewport({ width: 1280, height: 720 })
    await page.goto(long.address)
    const { colours } = await shown()
    assert.ok(colours > 40, `${colours} colours`)
    const n = (await inside('return v.view')).split(',').map(Number)
    for (const [i, x] of [0, 0, -13].entries()) assert.ok(Math.abs(n[i] - x) < 1e-3, `the eye: ${n.slice(0, 3)}`)
    assert.equal(await inside(`return $('name').textContent + $('state').textContent`), 'page.fxsFitting')
  })

  await test('a newer scene takes its place, and the camera stays', async () => {
    await page.mouse.move(300, 300)
    await page.mouse.down()
    await page.mouse.move(420, 260, { steps: 5 })
    await page.mouse.up()
    await pause(300)
    view = await inside('return v.view')
    const first = await shown()
    for (let next = first, tries = 0; next.hash === first.hash; next = await shown()) assert.ok(tries++ < 100, 'the same')
    assert.equal(await inside('return v.view'), view)
    assert.equal(await inside(`return v.shadowRoot.getElementById('loading').hidden`), true)
  })

  await test('numbers and the curve, on a wide page and a narrow one', async () => {
    await until(`return document.querySelectorAll('#curve circle').length > 1 && $('curve').querySelector('.end')`)
    const last = await inside(`return $('curve').querySelector('.end').textContent`)
    assert.match(last, /^\d+\.\d\d dB$/)
    assert.match(await inside(`return $('measured').textContent`), /^PSNR of 2 photographs held out$/)
    for (const id of ['step', 'gaussians']) assert.match(await inside(`return $('${id}').textContent`), /^[\d,]+$/)
    assert.match(await inside(`return $('left').textContent`), /left$/)
    for (const [width, height] of [[1280, 720], [390, 844]]) {
      await page.setViewport({ width, height })
      await still()
      await pause(500)
      await page.screenshot({ path: `${pictures}/fit-${width}.png` })
      const wide = await inside('return document.documentElement.scrollWidth')
      assert.ok(wide <= width, `${wide} pixels wide`)
      const box = await inside(`const b = $('curve').getBoundingClientRect(); return [b.left, b.right, b.top, b.bottom]`)
      assert.ok(box[0] >= 0 && box[1] <= width && box[2] >= 0 && box[3] <= height, `the curve: ${box}`)
    }
    await page.setViewport({ width: 1280, height: 720 })
  })

  await test('Ctrl-C: saved, and the page says so', async () => {
    long.fit.kill('SIGINT')
    assert.deepEqual(await long.exit, [null, 'SIGINT'])
    assert.match(long.said(), /stopped after \d+ steps of 40000; to go on: .* --resume page\.fxs\.fit\n/)
    await until(`return /^(Stopped, and saved|No answer)/.test($('state').textContent)`)
  })

  await test('it goes on when the fit does, and has the last scene when that is over', async () => {
    const steps = Number(long.said().match(/stopped after (\d+)/)[1]) + 3000
    const rest = await begin(port, '--resume', 'page.fxs.fit', '--steps', String(steps))
    await inside(`v.setAttribute('backend', 'webgl2')`)
    await until(`return v.backend === 'webgl2'`)
    await until(`return $('state').textContent === 'The fit is over'`)
    assert.deepEqual(await rest.exit, [0, null])
    assert.match(await inside(`return $('result').textContent`), /^All 2 photographs held out: \d+\.\d\d dB, SSIM 0\.\d{4}$/)
    assert.equal(await inside(`return $('step').textContent`), steps.toLocaleString('en'))
    assert.equal(await inside('return v.view'), view)
    await page.screenshot({ path: `${pictures}/fit-over.png` })
    for (const backend of ['webgl2', 'wasm']) {
      await inside(`v.setAttribute('backend', '${backend}')`)
      await until(`return v.backend === '${backend}'`)
      const { hash, size } = await shown()
      assert.equal(hash, rendered('page.fxs', view, size), backend)
    }
  })
} catch (error) {
  console.log(`FAIL page of a fit: ${error.stack} ${faults}`)
  process.exitCode = 1
}
for (const fit of fits) fit.kill('SIGKILL')
await browser.close()
