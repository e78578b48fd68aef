// Translates the texts of the viewer. The table of a language other than English is loaded when it is needed.

const TABLES = { de: () => import('./language_de.js'), zh: () => import('./language_zh.js') }
const NAMES = ['aria-label', 'title', 'placeholder']

export function chosen(asked) {
  const names = asked.map((one) => one.toLowerCase().split(/[-_]/)[0])
  return names.find((one) => one === 'en' || Object.hasOwn(TABLES, one)) ?? 'en'
}

export const askedFor = (name) => [name, ...(navigator.languages ?? [navigator.language])].filter(Boolean)

export class Language {
  name = 'en'
  #table = new Map()
  #seen = new WeakMap()
  #roots = []

  of(words, ...values) {
    let [at, text] = [0, this.#table.get(words)]
    while (!text && (at = words.indexOf(': ', at) + 2) > 1) text = this.#table.get(words.slice(at))
    return ((at > 1 ? words.slice(0, at) : '') + (text ?? words)).replace(/\{(\d)\}/g, (_, i) => values[i])
  }

  number(n) {
    return n.toLocaleString(this.name)
  }

  take(root) {
    if (!this.#roots.includes(root)) this.#roots.push(root)
    this.write(root)
  }

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
