// The page of a scene that `fixsplat view --web` serves: says what the server does with it, opens it when it is there,
// and puts each newer version in the place of the one on show, by the same camera. The address of the page chooses the
// scene (?scene=/scenes/0/NAME), other attributes of the element, and the camera (#view=...).
import './viewer.js'

const NAMES = ['cameras', 'background', 'budget', 'detail', 'backend', 'threads', 'turn', 'noui', 'ar']
const ASK_MS = 1000
const FIRST_MS = 300 // until there is a scene
const SILENT = 3 // questions without an answer, and the page says so

const params = new URLSearchParams(location.search)
const [, number] = (params.get('scene') ?? '').match(/^\/scenes\/(\d+)\//) ?? []
const told = document.getElementById('told')
const words = document.getElementById('words')
const bar = document.getElementById('bar')
const pause = (ms) => new Promise((done) => setTimeout(done, ms))

let viewer = null
let shown = 0 // the version on show, or the last that could not be

/** In the middle of an empty page, above where there is a scene; nothing without text. */
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

/** What goes on with the file, unless all is well. */
function tell({ name, state, done, words: why }) {
  const still = viewer ? '. This is what there was before' : ''
  if (state === 'packs' && !viewer) say(`Packing ${name}: ${Math.floor(100 * done)} %`, done)
  else if (state === 'waits' && !viewer) say(`${name} is next`)
  else if (state === 'failed' || state === 'gone') say(`${name}: ${why}${still}`)
  else say('')
}

const viewOfLink = () => new URLSearchParams(location.hash.slice(1)).get('view') ?? ''

function begin(address) {
  viewer = document.createElement('fixsplat-viewer')
  viewer.setAttribute('view', viewOfLink())
  for (const name of NAMES) if (params.has(name)) viewer.setAttribute(name, params.get(name))
  addEventListener('hashchange', () => viewer.setAttribute('view', viewOfLink()))
  viewer.setAttribute('src', address)
  document.body.append(viewer)
  viewer.focus({ focusVisible: false })
}

/** False where it is not the time for it. */
async function open(address) {
  if (!viewer) return begin(address)
  if (viewer.hasAttribute('open')) return viewer.replace(address)
  viewer.setAttribute('src', address)
}

async function show({ name, version, address }) {
  try {
    if ((await open(address)) !== false) shown = version
  } catch (error) {
    shown = version
    say(`${name} has changed, and cannot be shown: ${error.message}`)
    await pause(3 * ASK_MS)
  }
}

document.title = (params.get('scene') ?? '').split('/').pop() || document.title
for (let silent = 0; number; await pause(viewer ? ASK_MS : FIRST_MS)) {
  const facts = await ask()
  silent = facts ? 0 : silent + 1
  if (silent >= SILENT) say('The server does not answer: it has ended, or cannot be reached')
  if (!facts) continue
  document.title = facts.name
  tell(facts)
  if (facts.version && facts.version !== shown && !document.hidden) {
    await show(facts)
    tell(facts)
  }
}
if (!number) say('This address names no scene of this server')
