// Caches ranges of files in the browser's Cache API. The address of a cached range is PLACE/file/version/first-end,
// with the first byte and the end of the range. A full cache drops ranges of other files first.

const NAME = 'fixsplat'
const PLACE = 'https://fixsplat.invalid/'
const MOST = 1e9                // default capacity of the cache in bytes, for all files together

function entryOf(request) {
  const parts = request.url.slice(PLACE.length).split('/')
  const [first, end] = (parts[2] ?? '').split('-').map(Number)
  return end > first ? { request, file: parts[0], version: parts[1], first, end } : null
}

export class Store {
  #cache
  #prefix
  #own = new Map()              // cached ranges of the file of this Store, by their first byte
  #others = []                  // cached ranges of other files, the oldest first
  #bytes = 0
  #most
  #used = new Set()
  #writing = Promise.resolve()

  constructor(cache, prefix, most) {
    this.#cache = cache
    this.#prefix = prefix
    this.#most = most
  }

  static async open(url, version, { cache: most = MOST }) {
    if (!version || !most || !globalThis.caches) return null
    try {
      const [file, of] = [url.href.replace(/#.*/, ''), version].map(encodeURIComponent)
      const store = new Store(await caches.open(NAME), `${PLACE}${file}/${of}/`, most)
      await store.#list(file, of)
      return store
    } catch {
      return null
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

  get size() {
    return this.#own.size
  }

  find(byte) {
    const { first, end } = this.#own.get(byte) ?? [...this.#near(byte)][0] ?? {}
    return end > byte ? [first, end] : undefined
  }

  *#near(byte) {
    for (const entry of this.#own.values()) if (entry.first <= byte && entry.end > byte) yield entry
  }

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

  async clear() {
    for (const { first, end } of [...this.#own.values()]) this.drop(first, end)
    await this.#writing
  }
}
