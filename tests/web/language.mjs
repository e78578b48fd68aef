// node language.mjs VIEWER: checks that each translation of the viewer's texts has exactly the texts that the viewer
// shows. VIEWER is the viewer's folder.
import assert from 'node:assert/strict'
import { readdirSync, readFileSync } from 'node:fs'
import { resolve } from 'node:path'
import { pathToFileURL } from 'node:url'

const folder = resolve(process.argv[2])
const from = (name) => import(pathToFileURL(resolve(folder, name)))
const OTHERS = /^(fit|single|page|worker|engine|settings|track|language.*)\.js$/
const NO_WORDS = [/^(Space|Escape|ui bar|there are|A film of|frames: at most|no canvas for a worker|fixsplat render)$/,
  /^(The headset:|the headset's picture:)$/,
  /^(no WebAssembly|no files|no scene|this folder has more than)$/, /expected (?!a list)/, /: left out$/]

const wordsOfHtml = (html) => [
  ...html.replace(/<[^>]*>/g, '\n').split('\n'),
  ...[...html.matchAll(/(?:aria-label|title|placeholder)="([^"$]*)"/gs)].map(([, words]) => words.replace(/\s+/g, ' ')),
]

function textsOf(source) {
  const texts = []
  const templates = []
  let at = 0
  let before = '('
  const text = (end) => {
    const start = at
    while (!end.test(source.slice(at, at + 2))) at += source[at] === '\\' ? 2 : 1
    texts.push(source.slice(start, at))
  }
  const template = () => {
    text(/^(`|\$\{)/)
    if (source[at] === '`') at++
    else (at += 2), templates.push(0)
  }
  while (at < source.length) {
    const c = source[at++]
    if (c === "'") text(/^'/), at++
    else if (c === '`') template()
    else if (c === '/' && source[at] === '/') at = source.indexOf('\n', at)
    else if (c === '/' && source[at] === '*') at = source.indexOf('*/', at) + 2
    else if (c === '/' && /[(,=:[!&|?{};>]/.test(before)) {
      for (let inClass = false; source[at] !== '/' || inClass; at++)
        if (source[at] === '\\') at++
        else if (/[[\]]/.test(source[at])) inClass = source[at] === '['
      at++
    } else if (c === '{' && templates.length) templates[templates.length - 1]++
    else if (c === '}' && templates.length && templates[templates.length - 1]-- === 0) templates.pop(), template()
    if (/\S/.test(c)) before = c
  }
  return texts
}

const isCode = /[<>=$\\#@_]|--|:host|^[^A-Za-z{]*$|^[a-z-]+$|^\w*[a-z][A-Z]\w*$|^(M|[a-z]+ [a-z]+$).*\d/
const areWords = /[a-z]{2,} [A-Za-z{(\d]|^[A-Z][a-z]+( \(.\))?$|^\{0\} [a-z]|\{0\}$/
const isWords = (text) => areWords.test(text) && !isCode.test(text) && !NO_WORDS.some((one) => one.test(text))

export async function wordsOfViewer() {
  const { body, listOf } = await from('body.js')
  const { backends } = await from('picture.js')
  const html = [body, listOf('orbit'), listOf('fly'), listOf('walk')].flatMap(wordsOfHtml)
  const sources = readdirSync(folder).filter((name) => name.endsWith('.js') && !OTHERS.test(name) && name !== 'body.js')
  const said = sources.flatMap((name) => textsOf(readFileSync(resolve(folder, name), 'utf8')))
  const parts = said.flatMap((text) => (/<\w/.test(text) ? wordsOfHtml(text) : text.replace(/^: /, '')))
  const texts = parts.map((text) => text.trim()).filter(isWords)
  const all = [...html, ...Object.values(backends), ...texts].map((words) => words.trim())
  const isName = /^(fixsplat|@.*@|\..*, .*)$|^[A-Z ]+$/
  return [...new Set(all)].filter((words) => /[A-Za-z]{2}/.test(words) && !isName.test(words)).sort()
}

const wanted = await wordsOfViewer()
if (process.argv[3] === 'list') console.log(wanted.join('\n'))
for (const name of readdirSync(folder).filter((one) => /^language_.*\.js$/.test(one))) {
  const { words } = await from(name)
  assert.deepEqual(wanted.filter((one) => !words[one]), [], `${name} lacks`)
  assert.deepEqual(Object.keys(words).filter((one) => !wanted.includes(one)), [], `${name} has what nobody says`)
  const values = (text) => (text.match(/\{\d\}/g) ?? []).sort().join()
  for (const one of wanted) assert.equal(values(words[one]), values(one), one)
}
console.log(`ok ${wanted.length} words in each language`)
