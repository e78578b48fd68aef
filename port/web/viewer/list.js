// The list of scenes of `fixsplat view --web`, with the picture or the state of each scene.
import { Language, askedFor } from './language.js'

const ASK_MS = 1000
const cards = [...document.querySelectorAll('main > a')].map((card) => ({
  image: card.querySelector('img'),
  note: card.appendChild(document.createElement('small')),
  version: 0,
}))

const language = new Language()

function wordsOf({ state, done, words, picture }) {
  if (state === 'packs') return language.of('packing {0} %', Math.floor(100 * done))
  if (state === 'gone') return language.of('the file is not there any more')
  return state === 'failed' ? words : picture ? '' : '…'
}

function update({ image, note, ...card }, facts, number) {
  note.textContent = wordsOf(facts)
  if (facts.picture && facts.version !== card.version) image.src = `/scenes/${number}.jpg?${facts.version}`
  return facts.version
}

await language.choose(askedFor(new URLSearchParams(location.search).get('lang')))
document.documentElement.lang = language.name
document.title = document.querySelector('h1').textContent = language.of('Scenes')
for (;;) {
  const all = document.hidden ? [] : await fetch('/scenes.json', { cache: 'no-store' }).then((a) => a.json()).catch(() => [])
  all.forEach((facts, i) => {
    if (cards[i]) cards[i].version = update(cards[i], facts, i)
  })
  const isDone = all.length && all.every(({ picture, state }) => picture || state === 'failed' || state === 'gone')
  await new Promise((done) => setTimeout(done, isDone ? 5 * ASK_MS : ASK_MS))
}
