// node sound.mjs PACKAGE SCENES MODULES PICTURES COMMAND: checks the sound of moving scenes in the viewer's page.
import assert from 'node:assert/strict'
import { execFileSync } from 'node:child_process'
import { readFileSync, writeFileSync } from 'node:fs'
import { resolve } from 'node:path'
import { pathToFileURL } from 'node:url'
import * as chromium from './chromium.mjs'
import { base, go, inside, open, page, pause, picture, scenes, without, wordsOf } from './chromium.mjs'
import { POLICY } from './policy.mjs'

const { command, folder, policy, run } = chromium
const SECONDS = 2
const TAG = '"file":"audio/a.wav"'

const make = (...args) => execFileSync('python3', ['tests/scripts/lib/tsog.py', ...args])
const path = (name) => `${scenes}/${name}`
const scene = (name, ...more) => make(path('tsog.sog'), path(name), `${SECONDS}`, ...more)

function makeScenes() {
  execFileSync(command, ['make-scene', 'knot', '--count', '2000', '-o', path('tsog.ply')])
  execFileSync(command, ['convert', path('tsog.ply'), path('tsog.sog'), '--quiet'])
  make(path('a.wav'), `${SECONDS}`)
  make(path('short.wav'), '1')
  writeFileSync(path('empty.wav'), '')
  writeFileSync(path('text.wav'), 'no sound')
  scene('sound.tsog', `{${TAG},"volume":0.5}`, `audio/a.wav=${path('a.wav')}`)
  scene('typed.sog', '{"file":"a","mimeType":"audio/wav"}', `a=${path('a.wav')}`)
  scene('short.tsog', `{${TAG}}`, `audio/a.wav=${path('short.wav')}`)
  scene('silent.tsog')
  scene('missing.tsog', `{${TAG}}`)
  scene('empty.tsog', `{${TAG}}`, `audio/a.wav=${path('empty.wav')}`)
  scene('text.tsog', `{${TAG}}`, `audio/a.wav=${path('text.wav')}`)
  scene('kind.tsog', '{"file":"a.html"}', `a.html=${path('a.wav')}`)
  scene('wrong.tsog', '{"file":7}')
}

const AUDIO = `const audio = v.shadowRoot.querySelector('audio');`
const within = (body, ...args) => inside(AUDIO + body, ...args)
const until = (what) =>
  page.waitForFunction(`(() => { const v = document.querySelector('fixsplat-viewer')
    const audio = v?.shadowRoot?.querySelector('audio'), $ = (id) => v.shadowRoot.getElementById(id)
    return v?.shadowRoot && (${what}) })()`, { timeout: 60000 })

async function plays(address) {
  await go(`?scene=/scenes/${address}`)
  await until('v.playing && audio?.readyState && !audio.paused')
}

/** Opens a scene in a page that the user has not touched, where the sound is refused. Each function of puppeteer that
    runs in a page counts as a touch, so the page itself tells when it is muted. */
const isRefused = (address) => without(`const each = setInterval(() => {
    if (!document.querySelector('fixsplat-viewer')?.muted) return
    clearInterval(each)
    console.log('muted')
  }, 50)`, async () => {
  const told = new Promise((done, fail) => {
    page.on('console', (line) => line.text() === 'muted' && done())
    setTimeout(() => fail(new Error('it is not muted')), 60000)
  })
  await go(`?scene=/scenes/${address}`)
  await told
})

/** Plays for a while, and returns the share of pictures at which the sound was near the scene's time. */
const nearness = (seconds) => within(`const began = performance.now(), near = []
  while (performance.now() - began < 1000 * args[0]) {
    await new Promise(requestAnimationFrame)
    near.push(Math.abs(audio.currentTime - v.time) <= 0.1)
  }
  return near.filter(Boolean).length / near.length`, seconds)

makeScenes()
const tests = {
  async 'the sound in the file, in Node'() {
    const { load } = await import(pathToFileURL(resolve(folder, 'fixsplat.js')))
    const soundOf = async (name) => {
      const scene = await load(path(name), { threads: 1 })
      scene.free()
      return scene.sound
    }
    const { type, bytes, volume, failure } = await soundOf('sound.tsog')
    assert.deepEqual([type, volume, failure], ['audio/wav', 0.5, undefined])
    assert.deepEqual(Buffer.from(bytes), readFileSync(path('a.wav')))
    assert.deepEqual([(await soundOf('typed.sog')).type, (await soundOf('typed.sog')).volume], ['audio/wav', 1])
    assert.equal(await soundOf('silent.tsog'), null)
    assert.equal(await soundOf('tsog.sog'), null)
    assert.match((await soundOf('missing.tsog')).failure, /^missing.tsog: the sound audio\/a.wav is missing or damaged$/)
    assert.match((await soundOf('empty.tsog')).failure, /^empty.tsog: an empty sound$/)
    assert.match((await soundOf('kind.tsog')).failure, /the sound a.html is of a type that is not known$/)
    assert.match((await soundOf('wrong.tsog')).failure, /no valid "audio"$/)
  },

  async 'it starts muted where the browser refuses it; the button, key m and the attributes'() {
    await isRefused('sound.tsog&loop')
    await until('v.playing && v.time > 0.3')
    assert.deepEqual(await within(`return [v.muted, audio.paused, audio.volume, $('mute').title]`),
      [true, true, 0.5, 'Sound on (M)'])
    await picture('sound-muted')
    await inside(`window.told = []; v.addEventListener('volumechange', ({ detail }) => window.told.push(detail))`)
    await page.locator('fixsplat-viewer >>> #mute').click()
    await until('!v.muted && !audio.paused')
    assert.equal(await within(`$('stage').focus(); return $('mute').title`), 'Sound off (M)')
    await picture('sound')
    await page.keyboard.press('m')
    await until('v.muted && audio.paused')
    await within('v.muted = false; v.volume = 0.25')
    await until('!audio.paused && audio.volume === 0.25')
    await within('v.volume = null')
    await until('audio.volume === 0.5')
    assert.deepEqual(await inside('return window.told.map(({ muted, volume }) => [muted, volume])'),
      [[false, 0.5], [true, 0.5], [false, 0.5], [false, 0.25], [false, 0.5]])
    await go('?scene=/scenes/sound.tsog&muted&volume=0.75&playing=false')
    await until('audio?.readyState && v.paused')
    assert.deepEqual(await within('return [v.muted, audio.volume, audio.paused]'), [true, 0.75, true])
  },

  async 'it follows play, pause, seek, speed, loop and end'() {
    await plays('sound.tsog&loop')
    const share = await nearness(2 * SECONDS)
    console.log(`   near at ${(100 * share).toFixed(0)} % of the pictures`)
    assert.ok(share > 0.8, `${share}`)
    await within('v.pause()')
    const [rests, at] = await within('return [audio.paused, audio.currentTime]')
    await pause(200)
    assert.deepEqual([rests, await within('return audio.currentTime')], [true, at])
    await within('v.seek(0.7)')
    await until('!audio.seeking && Math.abs(audio.currentTime - 0.7) < 0.02')
    await within('v.speed = 2; v.play()')
    await until('!audio.paused && audio.playbackRate === 2')
    await within('v.speed = 0.5')
    await until('audio.playbackRate === 0.5')
    await within('v.seek(1.5)')
    await until('Math.abs(audio.currentTime - v.time) < 0.1 && v.time > 1.5')
    await within('v.seek(0); audio.currentTime = 1.2')
    await until('Math.abs(audio.currentTime - v.time) < 0.1 && v.time < 1')
    await within('v.speed = 50')
    await until('audio.paused && v.playing')
    await within('v.speed = 1; v.loop = false; v.seek(1.6)')
    await until('v.paused && audio.paused && v.time === 2')
    await within('v.play()')
    await until('v.playing && !audio.paused && audio.currentTime < 1')
    await within('window.audio = audio; v.remove()')
    await page.waitForFunction('window.audio.paused')
  },

  async 'under the policy of the documentation'() {
    policy.text = POLICY
    await plays('sound.tsog').finally(() => (policy.text = ''))
  },

  async 'a sound that is shorter than the scene'() {
    await plays('short.tsog&loop')
    await until('v.time > 1.2 && audio.paused')
    await until('v.time < 0.8 && !audio.paused && Math.abs(audio.currentTime - v.time) < 0.1')
  },

  async 'no button without a sound; a scene that follows'() {
    const has = `return [$('mute'), v.shadowRoot.querySelector('audio')].map((one) => !!one)`
    await go('?scene=/scenes/silent.tsog')
    await until('v.playing && v.time > 0.1')
    assert.deepEqual(await inside(has), [false, false])
    await plays('sound.tsog&loop')
    assert.deepEqual(await inside(has), [true, true])
    await inside(`await v.open('/scenes/silent.tsog')`)
    await until('v.playing && !audio')
    assert.deepEqual(await inside(has), [false, false])
    await inside(`v.sound = '/scenes/a.wav'`)
    await until('audio?.readyState && !audio.paused')
    await inside(`await v.open('/scenes/tsog.ply')`)
    await until(`v.state === 'still' && !audio`)
    assert.equal(await inside(`return v.shadowRoot.getElementById('mover').hidden`), true)
    await open('?scene=/scenes/tsog.ply&sound=/scenes/a.wav')
    assert.deepEqual(await inside(has), [false, false])
  },

  async 'a faulty sound: one message, and the scene plays'() {
    const faults = {
      'missing.tsog': 'missing.tsog: the sound audio/a.wav is missing or damaged',
      'empty.tsog': 'empty.tsog: an empty sound',
      'text.tsog': 'sound: this browser does not play this sound',
      'kind.tsog': 'kind.tsog: the sound a.html is of a type that is not known',
      'wrong.tsog': 'wrong.tsog: no valid "audio"',
      'silent.tsog&sound=/scenes/none.wav': 'none.wav: there is no sound at this address',
      'silent.tsog&sound=/scenes/text.wav': 'text.wav: this browser does not play this sound',
    }
    for (const [address, words] of Object.entries(faults)) {
      await go(`?scene=/scenes/${address}`)
      assert.equal(await wordsOf().catch(() => ''), words)
      await until('v.playing && v.time > 0.1')
      assert.equal(await inside(`return $('mute')`), null)
    }
  },

  async 'a published scene, in a folder and in one file'() {
    const env = { ...process.env, FIXSPLAT_WEB: folder }
    const publish = (...args) => execFileSync(command, ['publish', ...args, '--size', '160x90', '--quiet'], { env })
    publish(path('sound.tsog'), path('heard'))
    publish(path('silent.tsog'), path('given'), '--sound', path('short.wav'))
    publish('--single', path('sound.tsog'), path('heard.html'))
    for (const [address, seconds, volume] of [[`${base}/scenes/heard/index.html`, SECONDS, 0.5],
      [`${base}/scenes/given/index.html`, 1, 1], [`file://${path('heard.html')}`, SECONDS, 0.5]]) {
      await page.goto('about:blank')
      await page.goto(address)
      await until('v.playing && audio?.readyState && !audio.paused')
      const told = await within(`return [audio.duration, audio.volume, $('mute').checkVisibility()]`)
      assert.deepEqual(told, [seconds, volume, true])
    }
  },

  async 'narrow and wide pictures of the bar'() {
    for (const width of [320, 360, 1280]) {
      await go('?scene=/scenes/sound.tsog&playing=false', width, 640)
      await until(`v.state === 'still' && audio?.readyState`)
      await picture(`sound-${width}`)
      const isIn = await inside(`const all = [$('mover'), ...$('mover').children].filter((one) => one.checkVisibility())
        return all.every((one) => {
          const { left, right } = one.getBoundingClientRect()
          return left >= 0 && right <= innerWidth
        })`)
      assert.ok(isIn, `${width}`)
    }
  },
}

await run(tests)
