// The viewer's words in the language of who looks at it. They are written in English where they are used, and looked up
// in the table of a language, which is fetched when it is wanted. tests/web/language.mjs holds that each has all words.

const TABLES = { de: () => import('./language_de.js'), zh: () => import('./language_zh.js') }
const NAMES = ['aria-label', 'title', 'placeholder']

/** The first of the languages asked for that there is. */
export function chosen(asked) {
  const names = asked.map((one) => one.toLowerCase().split(/[-_]/)[0])
  return names.find((one) => one === 'en' || Object.hasOwn(TABLES, one)) ?? 'en'
}

/** The languages that somebody wants: one by name, then those of the browser. */
export const askedFor = (name) => [name, ...(navigator.languages ?? [navigator.language])].filter(Boolean)

export class Language {
  name = 'en'
  #table = new Map()
  #seen = new WeakMap() // of a text or an attribute: { english, written }
  #roots = []

  /** The words in this language; {0}, {1} and so on stand for values. Of a line with the name of a file in front what
      stands behind it. */
  of(words, ...values) {
    let [at, text] = [0, this.#table.get(words)]
    while (!text && (at = words.indexOf(': ', at) + 2) > 1) text = this.#table.get(words.slice(at))
    return ((at > 1 ? words.slice(0, at) : '') + (text ?? words)).replace(/\{(\d)\}/g, (_, i) => values[i])
  }

  number(n) {
    return n.toLocaleString(this.name)
  }

  /** Writes what is in an element in this language, now and whenever it is another. */
  take(root) {
    if (!this.#roots.includes(root)) this.#roots.push(root)
    this.write(root)
  }

  /** All but what has `translate="no"`. */
  write(root) {
    const own = (node) => (node.translate === false ? NodeFilter.FILTER_REJECT : NodeFilter.FILTER_ACCEPT)
    const walker = document.createTreeWalker(root, NodeFilter.SHOW_ELEMENT | NodeFilter.SHOW_TEXT, own)
    for (let node = root; node; node = walker.nextNode()) {
      if (node.nodeType === Node.TEXT_NODE) this.#one(node, 'data')
      else for (const name of NAMES) if (node.hasAttribute?.(name)) this.#one(node.getAttributeNode(name), 'value')
    }
    for (const child of root.children) child.lang = this.name
  }

  #one(node, field) {
    const seen = this.#seen.get(node)
    const english = seen?.written === node[field] ? seen.english : node[field]
    const words = english.trim()
    if (!words) return
    const written = english.replace(words, () => this.of(words))
    if (written !== node[field]) node[field] = written
    this.#seen.set(node, { english, written })
  }

  /** Takes the first of some languages that there is; true where that is another than before. */
  async choose(asked) {
    const name = chosen(asked)
    if (name === this.name) return false
    const table = name === 'en' ? { words: {} } : await TABLES[name]().catch(() => null)
    if (!table) return false
    this.name = name
    this.#table = new Map(Object.entries(table.words))
    for (const root of this.#roots) this.write(root)
    return true
  }
}
