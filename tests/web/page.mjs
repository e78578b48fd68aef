// node page.mjs PACKAGE SCENES MODULES PICTURES COMMAND: what tests/scripts/page.sh asks of the viewer's page.
import assert from 'node:assert/strict'
import { execFileSync } from 'node:child_process'
import { createReadStream, existsSync, readFileSync } from 'node:fs'
import { createServer } from 'node:http'
import { createRequire } from 'node:module'
import { resolve } from 'node:path'

const [folder, scenes, modules, pictures, command] = process.argv.slice(2)
const puppeteer = createRequire(resolve(modules, 'of'))('puppeteer-core')
const KINDS = {
  js: 'text/javascript',
  html: 'text/html',
  css: 'text/css',
  wasm: 'application/wasm',
  json: 'application/json',
}

const asked = []
const server = createServer((request, answer) => {
  const path = decodeURIComponent(new URL(request.url, 'http://x').pathname)
  const file = path.startsWith('/scenes/') ? scenes + path.slice(7) : folder + path
  asked.push(path)
  if (!existsSync(file)) return answer.writeHead(404).end()
  answer.setHeader('cross-origin-opener-policy', 'same-origin')
  answer.setHeader('cross-origin-embedder-policy', 'require-corp')
  answer.setHeader('content-type', KINDS[file.split('.').pop()] ?? 'application/octet-stream')
  if (request.url.includes('cut')) {
    answer.setHeader('content-length', 100000)
    answer.write(readFileSync(file).subarray(0, 5000), () => setTimeout(() => answer.destroy(), 50))
  } else createReadStream(file).pipe(answer)
}).listen(0, '127.0.0.1')
await new Promise((done) => server.once('listening', done))
const base = `http://127.0.0.1:${server.address().port}`

const browser = await puppeteer.launch({
  executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
  args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
})
const page = await browser.newPage()
const faults = []
page.on('pageerror', (error) => faults.push(error.message))
await page.emulateMediaFeatures([{ name: 'prefers-color-scheme', value: 'dark' }])
const strange = []
page.on(
  'request',
  (request) => !/^(http:\/\/127\.0\.0\.1|data:|blob:)/.test(request.url()) && strange.push(request.url())
)

async function go(address, width = 640, height = 360) {
  await page.setViewport({ width, height })
  await page.goto('about:blank')
  await page.goto(`${base}/viewer/index.html${address}`)
}

const inside = (body, ...args) =>
  page.evaluate(`(async (...args) => { const v = document.querySelector('fixsplat-viewer');
    const $ = (id) => v.shadowRoot.getElementById(id);
    ${body} })(...${JSON.stringify(args)})`)
const still = () => page.waitForSelector('fixsplat-viewer[state=still]', { timeout: 120000 })
const moved = async () => {
  await new Promise((done) => setTimeout(done, 700))
  await inside('for (let i = 0; i < 30; i++) await new Promise(requestAnimationFrame)')
  await still()
}
const wordsOf = async () => {
  await page.waitForFunction(
    () => !document.querySelector('fixsplat-viewer').shadowRoot.getElementById('error').hidden
  )
  return inside(`return $('words').textContent`)
}
const viewOf = () => inside('return v.view')
/** Of what the page shows, when a browser has shown it. */
const hash = async () => {
  await new Promise((done) => setTimeout(done, 250))
  return inside(`const seen = await createImageBitmap($('stage').lastElementChild), { width, height } = seen
  const copy = new OffscreenCanvas(width, height).getContext('2d')
  copy.drawImage(seen, 0, 0)
  const { data } = copy.getImageData(0, 0, width, height)
  let h = 0xcbf29ce484222325n;
  for (const b of data) h = BigInt.asUintN(64, (h ^ BigInt(b)) * 0x100000001b3n);
  return h.toString(16).padStart(16, '0')`)
}
const sizeOf = () => inside(`const { width, height } = await createImageBitmap($('stage').lastElementChild)
  return [width, height]`)
const picture = (name) => page.screenshot({ path: `${pictures}/${name}.png` })

/** The picture of the command for the same camera. */
function native(scene, view, size, background) {
  const n = view.split(',')
  return execFileSync(
    command,
    [
      'render',
      `${scenes}/${scene}`,
      '--eye',
      n.slice(0, 3).join(),
      '--look',
      n.slice(3, 6).join(),
      '--up',
      n.slice(6, 9).join(),
      '--fov',
      n[9],
      '--size',
      size,
      '--bg',
      background,
      '--hash',
    ],
    { encoding: 'utf8' }
  )
    .trim()
    .split(/\s/)[0]
}

const tests = {
  async 'empty page'() {
    await go('', 1280, 720)
    await picture('empty')
    assert.equal(await inside('return v.state'), 'empty')
    assert.equal(await inside(`return getComputedStyle($('empty')).display`), 'grid')
  },

  async 'the pixels of the command, and again by its link'() {
    await go('?scene=/scenes/scene.ply&background=%23102030#view=0.3,-0.9,-4,0,0,0,0,-1,0,45')
    await still()
    const [view, first] = [await viewOf(), await hash()]
    assert.equal(first, native('scene.ply', view, '640x360', '102030'))
    const link = await inside('return v.link')
    assert.match(link, /scene=http.*#view=0.3,-0.9,-4,/)
    await go(`${new URL(link).search}${new URL(link).hash}`)
    await still()
    assert.equal(await hash(), first)
    assert.deepEqual(strange, [])
  },

  async 'a drag, the wheel and keys move; r goes back'() {
    await go('?scene=/scenes/scene.ply')
    await still()
    const start = await viewOf()
    const motions = [
      () => page.mouse.wheel({ deltaY: -300 }),
      () => page.keyboard.press('ArrowLeft', { delay: 60 }),
      () => page.keyboard.press('w', { delay: 60 }),
      () => page.keyboard.press('+'),
      ...['left', 'right'].map((button) => async () => {
        await page.mouse.move(320, 180)
        await page.mouse.down({ button })
        await page.mouse.move(380, 150, { steps: 4 })
        await page.mouse.up({ button })
      }),
      () => page.mouse.click(320, 180, { count: 2 }),
    ]
    for (const move of motions) {
      const before = await viewOf()
      await move()
      await moved()
      assert.notEqual(await viewOf(), before, String(move))
    }
    await page.keyboard.press('r')
    await moved()
    assert.equal(await viewOf(), start)
    assert.deepEqual(await sizeOf(), [640, 360])
  },

  async 'touch: one finger turns, two move and zoom'() {
    await go('?scene=/scenes/scene.ply')
    await still()
    const touch = await page.createCDPSession()
    const points = (...list) => list.map(([x, y], id) => ({ x, y, id }))
    const send = (type, ...list) => touch.send('Input.dispatchTouchEvent', { type, touchPoints: points(...list) })
    const start = (await viewOf()).split(',').map(Number)
    await send('touchStart', [300, 180])
    await send('touchMove', [360, 180])
    await send('touchEnd')
    await moved()
    const turned = (await viewOf()).split(',').map(Number)
    assert.notDeepEqual(turned, start)
    assert.deepEqual(turned.slice(3, 6), start.slice(3, 6))
    await send('touchStart', [300, 180], [340, 180])
    await send('touchMove', [260, 180], [400, 200])
    await send('touchEnd')
    await moved()
    const pinched = (await viewOf()).split(',').map(Number)
    const far = (n) => Math.hypot(n[0] - n[3], n[1] - n[4], n[2] - n[5])
    assert.ok(far(pinched) < 0.5 * far(turned))
    assert.notDeepEqual(pinched.slice(3, 6), turned.slice(3, 6))
  },

  async 'resize keeps the vertical field of view'() {
    await go('?scene=/scenes/scene.ply')
    await still()
    const view = await viewOf()
    await page.setViewport({ width: 500, height: 420 })
    await moved()
    assert.equal(await viewOf(), view)
    assert.equal(await hash(), native('scene.ply', view, '500x420', '0e1116'))
  },

  async 'views of a cameras.json'() {
    await go('?scene=/scenes/scene.ply&cameras=/scenes/cameras.json')
    await still()
    const first = await viewOf()
    await page.keyboard.press('n')
    await moved()
    const second = await viewOf()
    assert.notEqual(second, first)
    await page.keyboard.press('p')
    await moved()
    assert.equal(await viewOf(), first)
    assert.equal(await hash(), native('scene.ply', first, '640x360', '0e1116'))
  },

  async 'the element in a page of its own; its end ends its worker'() {
    await go('')
    await page.setContent(`<base href="${base}/"><script type="module" src="viewer/viewer.js"></script>
      <fixsplat-viewer style="width: 300px; height: 200px" src="scenes/scene.ply"
        background="#000000"></fixsplat-viewer>`)
    await still()
    assert.equal(await hash(), native('scene.ply', await viewOf(), '300x200', '000000'))
    for (let i = 0; i < 5; i++) assert.ok(await inside(`return v.open(args[0])`, `${base}/scenes/scene.ply`))
    const workers = async (count) => {
      for (let i = 0; i < 50 && page.workers().length !== count; i++)
        await new Promise((done) => setTimeout(done, 100))
      assert.equal(page.workers().length, count)
    }
    await workers(1)
    await inside('v.remove()')
    await workers(0)
  },

  async 'errors in words; the page goes on'() {
    const wrong = {
      'none.ply': /no such file/,
      'text.ply': /text\.ply/,
      'short.ply': /short\.ply/,
      'huge.ply': /huge\.ply/,
      'scene.ply?cut': /broke off/,
      'http://127.0.0.1:1/a.ply': /cannot be reached/,
    }
    await go('?scene=/scenes/scene.ply')
    await still()
    const before = await hash()
    for (const [address, words] of Object.entries(wrong)) {
      await inside(
        `$('error').hidden = true; v.setAttribute('src', args[0])`,
        new URL(address, `${base}/scenes/`).href
      )
      assert.match(await wordsOf(), words)
    }
    await picture('error')
    await page.keyboard.press('ArrowLeft', { delay: 60 })
    await moved()
    assert.notEqual(await hash(), before)
    await go('?scene=/scenes/scene.ply&cameras=/scenes/text.ply')
    assert.match(await wordsOf(), /not JSON/)
    await go('?scene=/scenes/none.ply')
    assert.match(await wordsOf(), /no such file/)
    assert.equal(await inside('return v.state'), 'empty')
  },

  async 'a dropped file, and its picture as a .png'() {
    await go('')
    await inside(`const bytes = await (await fetch('/scenes/scene.ply')).arrayBuffer(); const data = new DataTransfer();
      data.items.add(new File([bytes], 'dropped.ply')); v.dispatchEvent(new DragEvent('drop', { dataTransfer: data }))`)
    await still()
    assert.equal(await inside(`return $('name').textContent`), 'dropped.ply')
    await inside(
      `HTMLAnchorElement.prototype.click = async function () { 
          const bytes = new Uint8Array(await (await fetch(this.href)).arrayBuffer());
          v.saved = [this.download, bytes.slice(1, 4).join()] }`
    )
    await page.keyboard.press('i')
    await page.waitForFunction(() => document.querySelector('fixsplat-viewer').saved)
    assert.deepEqual(await inside('return v.saved'), ['dropped.ply.png', '80,78,71'])
    await page.keyboard.press('l')
    assert.match(await inside(`return $('note').textContent`), /file of yours/)
  },

  async 'every control has a name; panels by key; noui'() {
    await go('?scene=/scenes/scene.ply')
    await still()
    assert.deepEqual(
      await inside(`return [...v.shadowRoot.querySelectorAll('button, input, select, section, #stage')].filter((e) =>
      !(e.ariaLabel || e.textContent.trim() || e.labels?.[0]?.textContent.trim())).map((e) => e.outerHTML)`),
      []
    )
    await page.keyboard.press('Tab')
    assert.equal(await inside('return v.shadowRoot.activeElement.id'), 'full')
    await page.keyboard.press('h')
    assert.equal(await inside(`return $('help').hidden`), false)
    await page.keyboard.press('Escape')
    assert.equal(await inside(`return $('help').hidden`), true)
    await go('?scene=/scenes/scene.ply&noui')
    await still()
    assert.deepEqual(
      await inside(
        `return [...v.shadowRoot.querySelectorAll('.ui')].filter((e) => getComputedStyle(e).display !== 'none').length`
      ),
      0
    )
  },

  async 'in the width of a phone nothing lies outside'() {
    await go('?scene=/scenes/scene.ply&cameras=/scenes/cameras.json', 360, 740)
    await still()
    for (const panel of ['options', 'help'])
      assert.deepEqual(
        await inside(`$('${panel}').hidden = false;
        const out = [...v.shadowRoot.querySelectorAll('button, p, label, dl')].filter((e) => {
        const r = e.getBoundingClientRect();
        return r.width && (r.left < 0 || r.right > 360) }).map((e) => e.id || e.outerHTML);
        $('${panel}').hidden = true; return out`),
        []
      )
    await picture('phone')
    await page.keyboard.press('h')
    await picture('phone-keys')
  },

  async 'captured scenes, and motion at a fraction of the size'() {
    const list = {
      guitar: 'guitar.compressed.ply',
      snowmiku: 'snowmiku.ply&cameras=/scenes/real/snowmiku/cameras.json',
    }
    for (const [folder, file] of existsSync(`${scenes}/real`) ? Object.entries(list) : []) {
      await go(`?scene=/scenes/real/${folder}/${file}`, 1280, 720)
      await page.waitForFunction(
        () => document.querySelector('fixsplat-viewer').shadowRoot.getElementById('percent').textContent
      )
      await picture(`${folder}-loading`)
      await still()
      await picture(folder)
      assert.equal(await hash(), native(`real/${folder}/${file.split('&')[0]}`, await viewOf(), '1280x720', '0e1116'))
      await inside(
        `v.seen = []; v.addEventListener('picture', ({ detail }) =>
          v.seen.push([detail.divisor, Math.round(detail.milliseconds)]))`
      )
      await page.keyboard.press('ArrowLeft', { delay: 1500 })
      await moved()
      const seen = await inside('return v.seen')
      console.log(
        `  ${folder}: divisor, ms: ${seen.slice(0, 3).join(' | ')} ... ${seen.slice(-3).join(' | ')}; ` +
          `${seen.length} pictures in 1.5 s`
      )
      assert.equal(seen.at(-1)[0], 1)
      assert.ok(seen.at(-1)[1] < 60 || seen.some(([divisor]) => divisor > 1))
    }
  },

  async 'pictures of the page'() {
    await go('?scene=/scenes/scene.ply', 1280, 720)
    await still()
    await picture('desktop')
    await page.keyboard.press('h')
    await picture('desktop-keys')
    await page.emulateMediaFeatures([{ name: 'prefers-color-scheme', value: 'light' }])
    await page.keyboard.press('Escape')
    await inside(`$('set').click()`)
    await moved()
    await picture('light')
  },
}

for (const [name, test] of Object.entries(tests)) {
  try {
    faults.length = 0
    await test()
    assert.deepEqual(faults, [])
    console.log(`ok ${name}`)
  } catch (error) {
    console.log(`FAIL ${name}: ${error.stack}`)
    process.exitCode = 1
  }
}
await browser.close()
server.close()
