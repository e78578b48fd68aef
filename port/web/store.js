// Keeps ranges of files in the browser's storage (Cache API), for the next visit. Each range is an entry whose address
// says of which file, in which version, and which bytes it is.

const NAME = 'fixsplat'
const PLACE = 'https://fixsplat.invalid/'
const MOST = 1e9                // bytes of all files

/** What an address of an entry says, or null. */
function entryOf(request) {
  const parts = request.url.slice(PLACE.length).split('/')
  const [first, end] = (parts[2] ?? '').split('-').map(Number)
  return end > first ? { request, file: parts[0], version: parts[1], first, end } : null
}

/** The ranges of one version of a file, among those of all files. */
export class Store {
  #cache
  #prefix
  #own = new Map()              // of this file: first byte to entry
  #others = []                  // entries of other files, the oldest first
  #bytes = 0                    // of all
  #most
  #used = new Set()
  #writing = Promise.resolve()

  constructor(cache, prefix, most) {
    this.#cache = cache
    this.#prefix = prefix
    this.#most = most
  }

  /** Null where nothing can be kept: by an option, in Node, on pages that are not secure, of files without version. */
  static async open(url, version, { cache: most = MOST }) {
    if (!version || !most || !globalThis.caches) return null
    try {
      const [file, of] = [url.href.replace(/#.*/, ''), version].map(encodeURIComponent)
      const store = new Store(await caches.open(NAME), `${PLACE}${file}/${of}/`, most)
      await store.#list(file, of)
      return store
    } catch {
      return null               // storage that is switched off
    }
  }

  async #list(file, version) {
    for (const request of await this.#cache.keys()) {
      const entry = entryOf(request)
      if (!entry || (entry.file === file && entry.version !== version)) this.#delete(request)
      else {
        this.#bytes += entry.end - entry.first
        if (entry.file === file) this.#own.set(entry.first, entry)
        else this.#others.push(entry)
      }
    }
  }

  /** How many ranges of this file there are. */
  get size() {
    return this.#own.size
  }

  /** The range that holds a byte: its first, and the one behind its last. */
  find(byte) {
    const { first, end } = this.#own.get(byte) ?? [...this.#near(byte)][0] ?? {}
    return end > byte ? [first, end] : undefined
  }

  *#near(byte) {
    for (const entry of this.#own.values()) if (entry.first <= byte && entry.end > byte) yield entry
  }

  /** The bytes of a range that was put. */
  async get(first, end) {
    const entry = this.#own.get(first)
    if (entry?.end !== end) return undefined
    this.#used.add(first)
    const answer = await this.#cache.match(entry.request).catch(() => undefined)
    const bytes = answer && new Uint8Array(await answer.arrayBuffer().catch(() => new ArrayBuffer(0)))
    if (bytes?.length === end - first) return bytes
    this.drop(first, end)
    return undefined
  }

  /** In the background; where there is no room, nothing is put any more. */
  put(first, end, bytes) {
    const size = end - first
    if (size > this.#most) return
    while (this.#bytes + size > this.#most) if (!this.#dropOldest()) return
    const request = new Request(`${this.#prefix}${first}-${end}`)
    this.#own.set(first, { request, first, end })
    this.#used.add(first)
    this.#bytes += size
    this.#writing = this.#writing
      .then(() => this.#cache.put(request, new Response(bytes)))
      .catch(() => {
        this.#most = 0
        this.#own.delete(first)
      })
  }

  /** Other files first, the oldest of them; then what was not used since this file was opened, then what was. */
  #dropOldest() {
    const other = this.#others.shift()
    if (other) {
      this.#bytes -= other.end - other.first
      this.#delete(other.request)
      return true
    }
    const own = [...this.#own.keys()].find((first) => !this.#used.has(first)) ?? this.#own.keys().next().value
    if (own === undefined) return false
    this.drop(own, this.#own.get(own).end)
    return true
  }

  drop(first, end) {
    const entry = this.#own.get(first)
    if (entry?.end !== end) return
    this.#own.delete(first)
    this.#bytes -= end - first
    this.#delete(entry.request)
  }

  #delete(request) {
    this.#writing = this.#writing.then(() => this.#cache.delete(request)).catch(() => {})
  }

  /** All of this file. */
  async clear() {
    for (const { first, end } of [...this.#own.values()]) this.drop(first, end)
    await this.#writing
  }
}
