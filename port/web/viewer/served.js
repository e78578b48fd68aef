// The page that shows one scene of the server `fixsplat view --web`. The page shows the progress of packing, then the
// packed scene and each newer version. The page's address sets the scene (?scene=/scenes/0/NAME) and other attributes.
import './viewer.js'
import { Language, askedFor } from './language.js'
import { followAddress } from './views.js'

const ASK_MS = 1000
const FIRST_MS = 300 // milliseconds between requests for the state until a scene is shown
const SILENT = 3

const params = new URLSearchParams(location.search)
const [, number] = (params.get('scene') ?? '').match(/^\/scenes\/(\d+)\//) ?? []
const told = document.getElementById('told')
const words = document.getElementById('words')
const bar = document.getElementById('bar')
const pause = (ms) => new Promise((done) => setTimeout(done, ms))
const language = new Language()

let viewer = null
let shown = 0

function say(text, done) {
  told.hidden = !text
  told.classList.toggle('over', !!viewer)
  words.textContent = text
  bar.hidden = done === undefined
  if (done !== undefined) bar.value = done
}

const ask = () =>
  fetch(`/scenes/${number}.json`, { cache: 'no-store' })
    .then((answer) => answer.json())
    .catch(() => null)

function tell({ name, state, done, words: why }) {
  const still = viewer ? `. ${language.of('This is what there was before')}` : ''
  if (state === 'packs' && !viewer) say(language.of('Packing {0}: {1} %', name, Math.floor(100 * done)), done)
  else if (state === 'waits' && !viewer) say(language.of('{0} is next', name))
  else if (state === 'gone') say(`${name}: ${language.of('the file is not there any more')}${still}`)
  else if (state === 'failed') say(`${name}: ${why}${still}`)
  else say('')
}

function begin(address, name) {
  viewer = document.createElement('fixsplat-viewer')
  viewer.setAttribute('src', address)
  viewer.setAttribute('label', name)
  viewer.toggleAttribute('edit', true)
  followAddress(viewer)
  document.body.append(viewer)
  viewer.focus({ focusVisible: false })
}

async function open(address, name) {
  if (!viewer) return begin(address, name)
  if (viewer.hasAttribute('open')) return viewer.replace(address)
  viewer.setAttribute('src', address)
}

async function show({ name, version, address }) {
  try {
    if ((await open(address, name)) !== false) shown = version
  } catch (error) {
    shown = version
    say(language.of('{0} has changed, and cannot be shown: {1}', name, error.message))
    await pause(3 * ASK_MS)
  }
}

document.title = (params.get('scene') ?? '').split('/').pop() || document.title
await language.choose(askedFor(params.get('lang')))
document.documentElement.lang = language.name
language.write(told)
for (let silent = 0; number; await pause(viewer ? ASK_MS : FIRST_MS)) {
  const facts = await ask()
  silent = facts ? 0 : silent + 1
  if (silent >= SILENT) say(language.of('The server does not answer: it has ended, or cannot be reached'))
  if (!facts) continue
  document.title = facts.name
  tell(facts)
  if (facts.version && facts.version !== shown && !document.hidden) {
    await show(facts)
    tell(facts)
  }
}
if (!number) say(language.of('This address names no scene of this server'))
