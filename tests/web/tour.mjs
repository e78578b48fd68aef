// node tour.mjs PACKAGE SCENES MODULES PICTURES COMMAND: checks the viewer's annotations, camera tracks, recorded
// films, settings files, sky pictures and languages.
import assert from 'node:assert/strict'
import { writeFileSync } from 'node:fs'
import * as chromium from './chromium.mjs'
import { go, hash, inside, moved, native, open, page, pause, picture, scenes, viewOf, wordsOf } from './chromium.mjs'
import { POLICY } from './policy.mjs'

const { policy, run } = chromium

const SCENE = '?scene=/scenes/scene.fxs'
const WITH = (file) => `${SCENE}&settings=/scenes/${file}`
const put = (name, value) =>
  writeFileSync(`${scenes}/${name}`, typeof value === 'string' ? value : JSON.stringify(value))
const numbersOf = async () => (await viewOf()).split(',').map(Number)
const noteOf = () => inside(`return $('note').textContent`)
const near = (a, b, by = 1e-6) => assert.ok(a.every((x, i) => Math.abs(x - b[i]) <= by), `${a}, and not ${b}`)

const features = (motion) =>
  page.emulateMediaFeatures([
    { name: 'prefers-color-scheme', value: 'dark' },
    { name: 'prefers-reduced-motion', value: motion },
  ])

const until = (what) =>
  page.waitForFunction(`(() => { const v = document.querySelector('fixsplat-viewer')
    const $ = (id) => v.shadowRoot.getElementById(id); return ${what} })()`)

async function shows(wanted) {
  for (let i = 0; (await hash()) !== wanted; i++) assert.ok(i < 40, `another picture than ${wanted}`)
}

const front = { eye: [0, 0, -9], look: [0, 0, 0], up: [0, -1, 0], fov: 40 }
const side = { eye: [-9, 0, 0], look: [0, 0, 0], up: [0, -1, 0], fov: 40 }
const keysOf = (...poses) => poses.map((pose, i) => ({ time: i / 2, ...pose }))
const TOUR = {
  fixsplat: 1,
  background: '#203040',
  camera: front,
  annotations: [
    { position: [0, 0, -2.5], title: 'The knot', text: 'Seen from the front.\nIn two lines.', camera: front },
    { position: [0.011, -2.642, 1.935], title: 'Behind', text: '', camera: side },
    { position: [2, 0.5, 0] },
  ],
  tracks: [
    { name: 'Around', loop: 'none', duration: 1, keys: keysOf(front, { ...front, eye: [-6, -2, -6] }, side) },
    { loop: 'repeat', keys: [{ time: 0, ...front }, { time: 0.8, ...side }] },
  ],
}
const THEIRS = {
  version: 2,
  tonemapping: 'filmic',
  highPrecisionRendering: false,
  background: { color: [0.2, 0.4, 0.6] },
  postEffectSettings: { bloom: { enabled: true, intensity: 0.1, blurLevel: 2 }, vignette: { enabled: true, intensity: 0.25 } },
  animTracks: [
    {
      name: 'theirs', duration: 2, frameRate: 30, loopMode: 'repeat', interpolation: 'spline', smoothness: 0.5,
      keyframes: {
        times: [0, 20, 45],
        values: { position: [0, 0, -9, 9, 2, 0, 0, 4, 9], target: Array(9).fill(0), fov: [60, 50, 70] },
      },
    },
  ],
  cameras: [{ initial: { position: [1, 2, -9], target: [0.5, 0, 0], fov: 60 } }],
  annotations: [
    {
      position: [0.5, 0.25, -2], title: 'Theirs', text: 'words',
      camera: { initial: { position: [0, 0, -7], target: [0, 0, 0], fov: 75 } },
    },
  ],
  startMode: 'default',
}

const THEIRS_AT = {
  0.3: [4.177285714285715, 0.6737142857142859, -5.968285714285715, 54.72214285714286],
  1.8: [-0.4397142857142857, 1.433714285714286, -2.548285714285713, 64.31714285714287],
}

const ends = [{ time: 0, ...front }, { time: 0.5, ...side }]
put('tour.json', TOUR)
put('film.json', { ...TOUR, tracks: [{ name: 'Around', keys: ends }] })

const tests = {
  async 'annotations: markers, their captions and links, by buttons and keys'() {
    policy.text = POLICY
    await open(WITH('tour.json'))
    policy.text = ''
    near(await numbersOf(), [0, 0, -9, 0, 0, 0, 0, -1, 0, 40])
    assert.equal(await hash(), native('scene.fxs', await viewOf(), '640x360', '203040'))
    await until(`v.shadowRoot.querySelector('.marker.behind')`)
    const markers = () => inside(`return [...v.shadowRoot.querySelectorAll('.marker')].map((one) => {
      const { x, y, width } = one.getBoundingClientRect()
      const isBehind = one.classList.contains('behind')
      return [one.textContent, one.ariaLabel, isBehind, one.hidden, x + width / 2, y + width / 2] })`)
    const [first, second, third] = await markers()
    assert.deepEqual(first.slice(0, 4), ['1', 'Annotation 1 of 3: The knot', false, false])
    near(first.slice(4), [320, 180], 1)
    assert.deepEqual(second.slice(0, 4), ['2', 'Annotation 2 of 3: Behind', true, false])
    const scale = 180 / Math.tan(Math.PI / 9) / 9
    near(third.slice(4), [320 + 2 * scale, 180 + 0.5 * scale], 1)
    await inside(`v.told = []; v.addEventListener('annotation', ({ detail: { index, annotation } }) =>
      v.told.push([index, annotation?.title]))`)
    await page.mouse.click(320, 180)
    assert.equal(await inside(`return $('caption').hidden`), false)
    const caption = await inside(`return $('caption').innerText`)
    assert.match(caption, /The knot\s+Seen from the front.\s+In two lines.\s+1 \/ 3/)
    await page.keyboard.press('.')
    await moved()
    near(await numbersOf(), [-9, 0, 0, 0, 0, 0, 0, -1, 0, 40])
    await inside(`$('later').click()`)
    await moved()
    assert.equal(await inside(`return $('caption').querySelector('h2').textContent`), 'Annotation 3')
    assert.ok(Math.abs((await numbersOf())[3] - 2) < 1e-9)
    await page.keyboard.press('Escape')
    assert.equal(await inside(`return $('caption').hidden`), true)
    assert.deepEqual(await inside('return v.told'), [[0, 'The knot'], [1, 'Behind'], [2, ''], [-1, null]])
    await picture('annotations')
    await inside(`navigator.clipboard.writeText = async (text) => { v.copied = text }
      await v.goTo(1); $('linkTo').click()`)
    await until('v.copied')
    const link = new URL(await inside('return v.copied'))
    assert.equal(link.hash, '#annotation=2')
    await open(link.search + link.hash)
    await moved()
    near(await numbersOf(), [-9, 0, 0, 0, 0, 0, 0, -1, 0, 40])
    assert.equal(await inside(`return $('caption').querySelector('h2').textContent`), 'Behind')
  },

  async 'in a card of 320 and of 240 pixels: captions and bars fit, nothing is cut'() {
    put('one.json', { ...TOUR, annotations: TOUR.annotations.slice(0, 1) })
    const outside = () => inside(`const out = [], box = v.getBoundingClientRect()
      const seen = (one) => one.checkVisibility({ visibilityProperty: true })
      for (const one of v.shadowRoot.querySelectorAll('button, input, output, .bar, section, h2, .title')) {
        if (!seen(one) || one.matches('.marker')) continue
        const { boxShadow } = getComputedStyle(one)
        const [, y = 0, blur = 0] = boxShadow.match(/-?[\\d.]+px/g)?.map(parseFloat) ?? []
        const { left, right, top, bottom, width } = one.getBoundingClientRect()
        const room = Math.min(left, box.width - right, top + y, box.height - bottom - y) - blur
        if (room < 0 || (one.matches('button') && width < 24)) out.push([one.id || one.className, room, width])
      }
      return [out, seen(v.shadowRoot.querySelector('nav'))]`)
    await features('reduce')
    await open(`${WITH('tour.json')}&cameras=/scenes/cameras.json`)
    for (const [width, height] of [[320, 240], [240, 320], [640, 360]]) {
      await page.setViewport({ width, height })
      await page.keyboard.press('Escape')
      assert.deepEqual(await outside(), [[], true])
      await inside('await v.goTo(0)')
      assert.deepEqual(await outside(), [[], width > 400])
      const [caption, text] = await inside(`return ['caption', 'captionText'].map((id) => $(id).offsetHeight)`)
      assert.ok(caption <= Math.max(150, 0.9 * height - 74) && text > 40, `${caption}, ${text}`)
      if (width === 320) await picture('card')
    }
    await page.setViewport({ width: 320, height: 240 })
    await inside(`v.camera = { eye: [0, -2.6, -6], look: [0, -2.6, 0] }; $('mark').click()`)
    await until('v.annotations.length === 4')
    const foot = await inside(`return ['newTitle', 'remove'].map((id) => $(id).getBoundingClientRect().bottom)`)
    assert.ok(foot[0] < foot[1] && foot[1] < 240, `${foot}`)
    assert.deepEqual(await outside(), [[], false])
    const arrows = () => inside(`return ['earlier', 'later', 'linkTo'].map((id) => $(id).checkVisibility())`)
    assert.deepEqual(await arrows(), [true, true, true])
    await inside(`v.settings = '/scenes/one.json'`)
    await until('v.annotations.length === 1')
    await inside('await v.goTo(0)')
    assert.deepEqual(await arrows(), [false, false, true])
    assert.equal(await inside(`return $('place').textContent`), '')
    await features('')
  },

  async 'no field keeps the focus, a caption gives it back to its marker; parts of the interface by ui and noui'() {
    await open(WITH('tour.json'))
    const focused = () => inside(`return v.shadowRoot.activeElement?.ariaLabel ?? v.shadowRoot.activeElement?.id`)
    await inside(`$('time').focus()`)
    await page.keyboard.press('ArrowRight')
    assert.ok((await inside('return v.time')) > 0)
    await page.keyboard.press('Tab')
    assert.equal(await focused(), 'Save a film')
    await inside(`v.shadowRoot.querySelector('.marker').focus()`)
    await page.keyboard.press('Enter')
    await inside(`$('closeCaption').focus()`)
    await page.keyboard.press('Enter')
    assert.equal(await focused(), 'Annotation 1 of 3: The knot')
    // Screen readers must skip the clock, because it changes with each picture.
    assert.equal(await inside(`return $('clock').getAttribute('aria-live')`), 'off')
    await inside('await v.goTo(0)')
    const parts = { markers: '#markers', caption: '#caption', player: '#player', bar: 'nav', corner: '.top' }
    const seen = () => inside(`return Object.entries(args[0]).filter(([, one]) =>
      getComputedStyle(v.shadowRoot.querySelector(one)).display !== 'none').map(([name]) => name).join()`, parts)
    assert.equal(await seen(), Object.keys(parts).join())
    for (const [ui, wanted] of [['annotations', 'markers,caption'], ['tracks', 'player'], ['', ''],
      ['annotations tracks', 'markers,caption,player']]) {
      await inside(`v.setAttribute('ui', args[0])`, ui)
      assert.equal(await seen(), wanted)
    }
    await inside(`v.removeAttribute('ui'); v.toggleAttribute('noui')`)
    assert.equal(await seen(), '')
  },

  async 'a track: played, paused by a hand, scrubbed, looped'() {
    await open(WITH('tour.json'))
    await inside(`v.told = []
      for (const name of ['play', 'pause', 'ended']) v.addEventListener(name, () => v.told.push(name))`)
    await page.keyboard.press('k')
    await until(`v.told.includes('ended')`)
    await moved()
    near(await numbersOf(), [-9, 0, 0, 0, 0, 0, 0, -1, 0, 40])
    assert.deepEqual(await inside('return v.told'), ['play', 'pause', 'ended'])
    await inside(`$('time').value = 0.5; $('time').dispatchEvent(new InputEvent('input', { bubbles: true }))`)
    await moved()
    near((await numbersOf()).slice(0, 3), [-6, -2, -6])
    assert.equal(await hash(), native('scene.fxs', await viewOf(), '640x360', '203040'))
    assert.equal(await inside(`return $('clock').textContent`), '0.5 / 1.0 s')
    await inside(`await v.play(1)`)
    await pause(1000)
    assert.equal(await inside('return v.paused'), false)
    assert.ok((await inside('return v.time')) < 0.8)
    await page.mouse.move(40, 120)
    await page.mouse.down()
    await page.mouse.move(60, 120, { steps: 3 })
    await page.mouse.up()
    await until('v.paused')
    await picture('track')
  },

  async 'settings of supersplat-viewer, version 2 and 1'() {
    put('theirs.json', THEIRS)
    await open(WITH('theirs.json'))
    // In settings files of supersplat-viewer y points up, and fov is the field of view of the picture's longer side.
    const upright = (fov) => (360 / Math.PI) * Math.atan(Math.tan((fov * Math.PI) / 360) * (360 / 640))
    near(await numbersOf(), [-1, -2, -9, -0.5, 0, 0, 0, -1, 0, upright(60)])
    assert.match(await wordsOf(), /theirs.json: postEffectSettings: bloom: not drawn here/)
    assert.deepEqual(await inside('return [v.settings.tone, v.settings.vignette]'), ['filmic', 0.25])
    assert.equal(await hash(), native('scene.fxs', await viewOf(), '640x360', '336699'))
    const { annotations, tracks } = await inside('return { annotations: v.annotations, tracks: v.tracks }')
    assert.deepEqual(annotations[0].position, [-0.5, -0.25, -2])
    assert.deepEqual(tracks[0].keys.map(({ time }) => time), [0, 20 / 30, 1.5])
    for (const [time, wanted] of [[0.3, THEIRS_AT[0.3]], [1.8, THEIRS_AT[1.8]]]) {
      await inside('v.seek(args[0])', time)
      await moved()
      const [x, y, z, , , , , , , fov] = await numbersOf()
      near([x, y, z, fov], [-wanted[0], -wanted[1], wanted[2], upright(wanted[3])], 1e-9)
    }
    await page.setViewport({ width: 360, height: 640 })
    await inside('v.seek(0)')
    await moved()
    near([(await numbersOf())[9]], [60])
    const { values } = THEIRS.animTracks[0].keyframes
    const early = { frameRate: undefined, loopMode: 'none', keyframes: { times: [0, 0.2, 0.4], values } }
    put('early.json', {
      camera: { position: [0, 1, -9], target: [0, 0, 0], startAnim: 'animTrack' },
      background: {},
      animTracks: [{ ...THEIRS.animTracks[0], ...early }],
    })
    await open(WITH('early.json'))
    await until('v.time > 0.1')
    await inside('v.pause()')
    await features('reduce')
    await open(WITH('early.json'))
    await pause(500)
    // If the user prefers reduced motion, a camera track does not start by itself.
    assert.equal(await inside('return v.paused && v.time'), 0)
    await features('')
  },

  async 'settings that are wrong: a line in words, the rest is shown'() {
    const wrong = {
      'none.json': /none.json: there are no settings at this address/,
      'text.ply': /text.ply: this is no settings file: it is not JSON/,
      'cameras.json': /cameras.json: this is no settings file: expected an object/,
      'version.json': /version 7: expected 1 or 2/,
      'types.json': /camera: expected an object: left out.*background.*start.*ar: expected one of table.*annotations: expected a list/s,
      'many.json': /annotations: 1000000 of them: the first 200 are shown/,
      'keys.json': /tracks 1, key 3: its time is not behind.*tracks 2: it has no key.*tracks 3, key 1.fov: expected 1 to/s,
    }
    put('version.json', { version: 7 })
    put('types.json', { fixsplat: 1, camera: [1], background: 5, start: 'x', ar: 1, annotations: {}, tracks: TOUR.tracks })
    put('many.json', `{"fixsplat":1,"annotations":[${Array(1e6).fill('{"position":[0,0,0]}').join()}]}`)
    const swapped = [0, 2, 1].map((time) => ({ time, ...front }))
    put('keys.json', { fixsplat: 1, annotations: TOUR.annotations, tracks: [{ keys: swapped }, { keys: [] },
      { keys: [{ time: 0, ...front, fov: 'NaN' }] }, { keys: [{ time: 0, ...side }] }] })
    await open(WITH('none.json'))
    for (const [file, words] of Object.entries(wrong)) {
      await inside(`$('words').textContent = ''
        for (const file of ['', 'tour.json', args[0]]) v.setAttribute('settings', file && '/scenes/' + file)`, file)
      await until(`${words}.test($('words').textContent)`)
      if (file === 'many.json') assert.equal(await inside(`return v.shadowRoot.querySelectorAll('.marker').length`), 200)
    }
    await moved()
    assert.deepEqual(await inside('return [v.annotations.length, v.tracks.length, v.duration]'), [3, 1, 1])
    await inside('await v.play()')
    await until('v.paused')
    near(await numbersOf(), [-9, 0, 0, 0, 0, 0, 0, -1, 0, 40])
    const none = await inside(`return v.goTo(500).catch((error) => error.message)`)
    assert.match(none, /annotation 500: there are 3, expected 0 to 2$/)
    assert.match(await inside(`v.tracks = [{ keys: [{ time: -1 }] }]; await new Promise((done) => setTimeout(done, 100));
      return $('words').textContent`), /tracks 1, key 1.eye: expected three numbers/)
  },

  async 'a place is marked, a track is made of views, and the settings that are saved are read again'() {
    await open(SCENE)
    await inside(`HTMLAnchorElement.prototype.click = async function () {
      v.saved = [this.download, await (await fetch(this.href)).text()] }`)
    await inside(`$('set').click(); $('mark').click()`)
    await until('v.annotations.length')
    await page.keyboard.type('A place')
    for (const key of ['Escape', 'ArrowLeft']) await page.keyboard.press(key, { delay: 60 })
    await moved()
    await inside(`$('addKey').click()`)
    await page.keyboard.press('ArrowLeft', { delay: 60 })
    await moved()
    await inside(`$('addKey').click()`)
    await until('v.duration === 2')
    await inside(`v.setAttribute('background', '#405060'); v.setAttribute('ar', 'true'); $('save').click()`)
    await until('v.saved')
    const [name, text] = await inside('return v.saved')
    assert.equal(name, 'settings.json')
    const [view, first] = [await viewOf(), await hash()]
    put('saved.json', text)
    await open(WITH('saved.json'))
    assert.equal(await viewOf(), view)
    assert.equal(await hash(), first)
    assert.equal(await inside('return v.settings.ar'), 'true')
    assert.equal((await inside('return v.annotations'))[0].title, 'A place')
    assert.deepEqual(JSON.parse(text).tracks, await inside('return v.tracks'))
    await inside(`const data = new DataTransfer(), text = JSON.stringify({ fixsplat: 1, tracks: args[0] })
      data.items.add(new File([text], 'dropped.json'))
      v.dispatchEvent(new DragEvent('drop', { dataTransfer: data }))`, TOUR.tracks)
    await until('v.tracks.length === 2')
  },

  async 'keys of a track: moved in time, past another key, and removed; the command of its film'() {
    await open(WITH('tour.json'))
    const field = (i) => `v.shadowRoot.querySelectorAll('#keyList input')[${i}]`
    const times = () => inside('return v.tracks.map(({ keys, duration }) => [...keys.map(({ time }) => time), duration])')
    const put = (i, time) => inside(`${field(i)}.value = '${time}'; ${field(i)}.dispatchEvent(new Event('change'))`)
    await inside(`$('editKeys').click()`)
    await until(field(2))
    await picture('keys')
    const eyes = () => inside('return v.tracks[0].keys.map(({ eye }) => eye[0])')
    await put(1, 0.8)
    assert.deepEqual(await times(), [[0, 0.8, 1, 1], [0, 0.8, 0.8]])
    await put(1, 2.5)
    assert.deepEqual([await times(), await eyes()], [[[0, 1, 2.5, 2.5], [0, 0.8, 0.8]], [0, -9, -6]])
    for (const wrong of ['1', '-1', '']) await put(2, wrong)
    assert.equal(await noteOf(), 'Another key has this time')
    assert.deepEqual(await inside(`return [${field(2)}.value, v.tracks[0].keys.length]`), ['2.5', 3])
    await inside(`$('show1').click()`)
    await moved()
    near(await numbersOf(), [-9, 0, 0, 0, 0, 0, 0, -1, 0, 40])
    await inside(`$('remove2').click()`)
    assert.deepEqual(await times(), [[0, 1, 1], [0, 0.8, 0.8]])
    const command = "fixsplat render 'scene.fxs' --path settings.json --fps 30 --size 640x360 --bg 203040 -o film.mp4"
    await inside(`HTMLAnchorElement.prototype.click = function () { v.saved = this.download }
      navigator.clipboard.writeText = async (text) => { v.copied = text }; $('saveTrack').click()`)
    await until('v.saved && v.copied')
    assert.deepEqual(await inside(`return [v.saved, v.copied, $('command').value]`), ['settings.json', command, command])
    await inside(`$('track').value = 1; $('track').onchange()`)
    assert.match(await inside(`return $('command').value`), /settings.json --track 1 --fps/)
    await inside(`$('remove0').click(); $('remove0').click()`)
    assert.deepEqual(await times(), [[0, 1, 1]])
    await page.keyboard.press('Escape')
    assert.equal(await inside(`return $('trackKeys').hidden`), true)
  },

  async 'languages: by the attribute and by the browser, every word of the page; English fetches none'() {
    const asked = []
    const late = /\/(?:language_(..)|(tour|tour_style|markers|player|settings|track|film|sky|walk|gamepad|joystick))\.js/
    const hear = (request) => asked.push(...(request.url().match(late)?.slice(1).filter(Boolean) ?? []))
    page.on('request', hear)
    await open(SCENE)
    assert.deepEqual(asked, [])
    const texts = () => inside(`const walker = document.createTreeWalker(v.shadowRoot, NodeFilter.SHOW_ALL,
        (node) => (node.translate === false || /^(draws|readout|note)$/.test(node.id) || node.nodeName === 'KBD' ? 2 : 1))
      const seen = []
      for (let node = walker.nextNode(); node; node = walker.nextNode()) {
        if (node.nodeType === 3) seen.push(node.data)
        else for (const name of ['aria-label', 'title', 'placeholder']) seen.push(node.getAttribute?.(name) ?? '')
      }
      return seen.map((text) => text.trim()).filter((text) => /\\p{L}{2}/u.test(text))`)
    const speaks = (lang) => until(`$('stage').lang === '${lang}'`)
    await open(WITH('tour.json'))
    const english = await texts()
    assert.deepEqual([...new Set(asked)].sort(), ['markers', 'player', 'settings', 'tour', 'tour_style', 'track'])
    for (const [lang, one] of [['de', 'Vorige Anmerkung (,)'], ['zh-TW', '上一个标注 (,)']]) {
      await inside(`v.setAttribute('lang', args[0])`, lang)
      await speaks(lang.slice(0, 2))
      const words = await texts()
      assert.ok(words.includes(one), words.join())
      const same = english.filter((text) => words.includes(text))
      const known = /^(fixsplat|ACES|Splats|Text|Shift|Around|Track 2|Behind|The knot|.*\.(ply|fxs).*|\d+ splats)$/
      assert.deepEqual(same.filter((text) => !known.test(text)), [])
      await inside(`v.setAttribute('lang', 'en')`)
      await speaks('en')
      assert.deepEqual((await texts()).filter((text) => !english.includes(text) && !known.test(text)), [])
    }
    assert.deepEqual(asked.filter((one) => one.length === 2), ['de', 'zh'])
    page.off('request', hear)
    const { identifier } = await page.evaluateOnNewDocument(() =>
      Object.defineProperty(navigator, 'languages', { get: () => ['xx', 'de-AT', 'en'] }))
    await open(`${SCENE}&settings=/scenes/none.json`)
    await speaks('de')
    assert.equal(await wordsOf(), 'none.json: an dieser Adresse sind keine Einstellungen')
    assert.equal(await inside(`return $('count').textContent`), '20.000 Splats')
    await picture('german')
    await page.removeScriptToEvaluateOnNewDocument(identifier)
  },

  async 'a film of a track: every frame goes in as the command draws it'() {
    await open(WITH('film.json'), 320, 180)
    const film = (before) => inside(`${before}
      const { blob, codec, frames, width, height } = await v.film({ rate: 12, width: 321, height: 180 })
      const bytes = new Uint8Array(await blob.arrayBuffer())
      let text = ''
      for (let i = 0; i < bytes.length; i += 4096) text += String.fromCharCode(...bytes.subarray(i, i + 4096))
      const video = Object.assign(document.createElement('video'), { src: URL.createObjectURL(blob), muted: true })
      await new Promise((done, fail) => Object.assign(video, { onloadeddata: done, onerror: () => fail(video.error) }))
      video.currentTime = 0.35
      await new Promise((done) => (video.onseeked = done))
      const context = new OffscreenCanvas(width, height).getContext('2d')
      let data = [0, 0, 0, 0]
      for (let i = 0; i < 100 && !data[3]; i++) { // a frame may come after its event
        context.drawImage(video, 0, 0)
        data = context.getImageData(0, 0, width, height).data
        if (!data[3]) await new Promise((done) => setTimeout(done, 50))
      }
      let sum = 0
      for (let i = 0; i < data.length && v.frames; i++) if (i % 4 < 3) sum += (data[i] - v.frames[4][i]) ** 2
      const psnr = 10 * Math.log10((255 ** 2 * 3 * width * height) / sum)
      const { videoWidth, videoHeight, duration } = video
      return { text: btoa(text), codec, frames, size: [videoWidth, videoHeight], duration, psnr, hashes: v.hashes }`)
    const told = await film(`v.frames = [], v.hashes = []
      const Own = VideoFrame
      window.VideoFrame = class extends Own { constructor(bytes, how) {
        super(bytes, how)
        if (!how.format) return
        let h = 0xcbf29ce484222325n
        for (const b of bytes) h = BigInt.asUintN(64, (h ^ BigInt(b)) * 0x100000001b3n)
        v.hashes.push(h.toString(16).padStart(16, '0'))
        v.frames.push(bytes.slice()) } }`)
    writeFileSync(`${scenes}/film.webm`, Buffer.from(told.text, 'base64'))
    assert.deepEqual([told.frames, told.size, told.duration], [6, [322, 180], 0.5])
    assert.match(told.codec, /^VP[89]$/)
    assert.ok(told.psnr > 30, `${told.psnr} dB`)
    for (const i of [0, 3]) {
      await inside('v.seek(args[0])', i / 12)
      await moved()
      assert.equal(told.hashes[i], native('scene.fxs', await viewOf(), '322x180', '203040'))
    }
    const recorded = await film('delete window.VideoEncoder; v.frames = null')
    assert.deepEqual([recorded.codec, recorded.frames, recorded.size], ['MediaRecorder', 6, [322, 180]])
    const stopped = await inside(`const progress = (share) => { if (share) throw new Error('enough') }
      return v.film({ progress }).catch((error) => error.message)`)
    assert.equal(stopped, 'enough')
  },

  async 'the button of a film: progress, the file, and what the codec does'() {
    await open(WITH('film.json'), 320, 180)
    await inside(`HTMLAnchorElement.prototype.click = function () { v.saved = this.download }; $('film').click()`)
    await until('v.saved')
    assert.equal(await inside('return v.saved'), 'Around.webm')
    assert.match(await noteOf(), /Film saved: 15 frames of 320 × 180, by VP[89], which changes their bytes/)
    await inside(`$('film').click(); $('film').click()`)
    await until(`/stopped/.test($('note').textContent)`)
  },

  async 'a sky: the bytes of a backdrop, by the processor and by WebGL; words where there is none'() {
    await open(SCENE)
    const png = await inside(`const canvas = new OffscreenCanvas(64, 32), context = canvas.getContext('2d')
      for (let i = 0; i < 2048; i++) {
        const [x, y] = [i % 64, i >> 6]
        context.fillStyle = \`rgb(\${4 * x} \${8 * y} 80)\`
        context.fillRect(x, y, 1, 1)
      }
      return btoa(String.fromCharCode(...new Uint8Array(await (await canvas.convertToBlob()).arrayBuffer())))`)
    writeFileSync(`${scenes}/sky.png`, Buffer.from(png, 'base64'))
    const places = [[0, 0], [639, 0], [0, 359], [639, 359], [20, 180]]
    const pixels = () => inside(`const seen = await createImageBitmap($('stage').lastElementChild)
      const context = new OffscreenCanvas(seen.width, seen.height).getContext('2d')
      context.drawImage(seen, 0, 0)
      return args[0].map((at) => [...context.getImageData(...at, 1, 1).data.slice(0, 3)])`, places)
    const hashes = []
    for (const backend of ['wasm', 'webgl2']) {
      await open(`${SCENE}&skybox=/scenes/sky.png&backend=${backend}#view=0,0,-9,0,0,0,0,-1,0,40`)
      hashes.push(await hash())
      await pause(200)
      const seen = await pixels()
      for (const [i, [x, y]] of places.entries()) {
        const f = 180 / Math.tan(Math.PI / 9)
        const ray = [(x + 0.5 - 320) / f, (y + 0.5 - 180) / f, 1]
        const u = 0.5 + Math.atan2(ray[0], ray[2]) / 2 / Math.PI
        const v = 0.5 + Math.atan2(ray[1], Math.hypot(ray[0], 1)) / Math.PI
        near(seen[i], [4 * (64 * u - 0.5), 8 * (32 * v - 0.5), 80], 1.1)
      }
    }
    assert.equal(hashes[0], hashes[1])
    const before = await hash()
    await inside(`v.setAttribute('skybox', '/scenes/text.ply')`)
    assert.match(await wordsOf(), /text.ply: this browser does not read it as a picture/)
    await moved()
    await shows(native('scene.fxs', await viewOf(), '640x360'))
    await inside(`$('error').hidden = true; v.setAttribute('skybox', '/scenes/none.png')`)
    assert.match(await wordsOf(), /none.png: there is no picture at this address/)
    await inside(`v.setAttribute('skybox', '/scenes/sky.png')`)
    await shows(before)
    await picture('sky')
    const others = ['https://localhost:1/sky.png', '//localhost:1/sky.png', ' //localhost:1/sky.png', '/sky.png',
      '../sky.png', '%2e%2e/sky.png', 'file:///sky.png', 'blob:sky.png', '\\\\localhost\\sky.png']
    for (const skybox of others) {
      put('skybox.json', { fixsplat: 1, skybox })
      await go(WITH('skybox.json'))
      assert.equal(await wordsOf(), 'skybox.json: skybox: leaves the folder of this file: left out')
      assert.equal(await inside(`return v.getAttribute('skybox')`), null)
    }
    put('skybox.json', { fixsplat: 1, skybox: 'sky.png?2' })
    await open(WITH('skybox.json'))
    assert.match(await inside(`return v.getAttribute('skybox')`), /\/scenes\/sky\.png\?2$/)
  },
}

await run(tests)
