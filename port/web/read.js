// Reads the file of a scene and the other files that it names, from addresses, local files or memory.

import { inNode, ofSystem } from './fixsplat_assets.js'

const MOST = 2e9
const MOST_ALL = 4e9
const BLOCK = 1 << 20
const AT_ONCE = 16             // largest number of simultaneous requests for files that a scene file names
// A request times out if fewer than `bytes` bytes arrive in `milliseconds` milliseconds.
const SLOWEST = { bytes: 1000, milliseconds: 30000 }

const sizeOf = (bytes) => (bytes < 1e9 ? `${(bytes / 1e6).toFixed(1)} MB` : `${(bytes / 1e9).toFixed(1)} GB`)

/** The received bytes of a file. `total` is the size that the server announced; 0: unknown. */
export class SourceFile {
  #blocks = []
  #each = BLOCK
  #least = 0
  there = 0

  constructor(name, total = 0, most = MOST) {
    Object.assign(this, { name, total, most })
    this.#check(total)
  }

  static of(name, bytes) {
    const file = new SourceFile(name, bytes.length)
    file.#blocks = [bytes]
    file.#each = Infinity
    file.there = bytes.length
    return file
  }

  tooLarge(bytes, most = this.most) {
    const words = this.#least
      ? `${sizeOf(bytes)} or more, though its header asks for ${sizeOf(this.#least)}`
      : `${sizeOf(bytes)}, and no more than ${sizeOf(most)} can be read`
    return Object.assign(new Error(`${this.name}: ${words}`), { isLarge: true })
  }

  limit(least) {
    this.#check(least)
    this.#least = least
    this.most = Math.min(this.most, 16 * least + BLOCK)
    this.#check(this.total)
  }

  #check(bytes) {
    if (bytes > this.most) throw this.tooLarge(bytes)
  }

  add(part) {
    this.#check(this.there + part.length)
    if (this.total && this.there + part.length > this.total)
      throw new Error(`${this.name}: more than the ${this.total} bytes that the server has announced`)
    for (let at = 0; at < part.length; ) {
      const used = this.there % BLOCK
      if (!used) this.#blocks.push(new Uint8Array(Math.min(BLOCK, Math.max(this.total - this.there, 0) || BLOCK)))
      const some = part.subarray(at, at + this.#blocks.at(-1).length - used)
      this.#blocks.at(-1).set(some, used)
      this.there += some.length
      at += some.length
    }
  }

  copy(offset, out) {
    for (let at = 0; at < out.length; ) {
      const from = offset + at
      const block = this.#blocks[Math.floor(from / this.#each)]
      const some = block.subarray(from % this.#each).subarray(0, out.length - at)
      out.set(some, at)
      at += some.length
    }
    return out
  }

  first(count) {
    return this.copy(0, new Uint8Array(Math.min(count, this.there)))
  }

  starts(text) {
    return String.fromCharCode(...this.first(text.length)) === text
  }

  get isPacked() {
    return this.starts('FXS1')
  }
}

// ---- Requests -------------------------------------------------------------------------------------------------

export const later = (call, milliseconds) => {
  const timer = setTimeout(call, milliseconds)
  timer.unref?.()               // in Node, a pending timer would keep the process alive
  return timer
}

/** Aborts a request if fewer than SLOWEST.bytes bytes arrive in `silence` milliseconds. Only the time in the method
    `wait` counts. */
export class Watch {
  #name
  #silence
  #left
  #bytes = 0
  #signal
  #over
  #stop
  #aborted = () => this.#end(this.#signal.reason)
  request = new AbortController()
  failure = null

  constructor(name, { silence = SLOWEST.milliseconds, signal } = {}) {
    this.#name = name
    this.#silence = this.#left = silence
    this.#signal = signal
    this.#over = new Promise((_, reject) => (this.#stop = reject))
    this.#over.catch(() => {})
    if (signal?.aborted) this.#aborted()
    else signal?.addEventListener('abort', this.#aborted)
  }

  #end(error) {
    this.failure ??= error
    this.#stop(error)
    this.request.abort(error)
  }

  async wait(promise) {
    const start = performance.now()
    const timer = later(() => {
      const did = this.#bytes ? `sent ${this.#bytes} bytes in` : 'was silent for'
      const words = `${this.#name}: the server ${did} ${this.#silence / 1000} seconds`
      this.#end(Object.assign(new Error(words), { isSlow: true }))
    }, this.#left)
    try {
      return await Promise.race([promise, this.#over])
    } finally {
      clearTimeout(timer)
      this.#left -= performance.now() - start
    }
  }

  heard(bytes) {
    this.#bytes += bytes
    if (this.#bytes < SLOWEST.bytes) return
    this.#bytes = 0
    this.#left = this.#silence
  }

  end() {
    this.#signal?.removeEventListener('abort', this.#aborted)
  }
}

export async function fetched(name, url, options) {
  const answer = await fetch(url, options)
  if (!/^https:/i.test(url) || !/^http:/i.test(answer.url)) return answer
  answer.body?.cancel().catch(() => {})
  throw Object.assign(new Error(`${name}: the server leads from https to ${answer.url}, which anybody may change`), {
    isLasting: true,
  })
}

// ---- Addresses ------------------------------------------------------------------------------------------------

export async function urlOf(text) {
  if (!inNode) return new URL(text, globalThis.document?.baseURI ?? globalThis.location?.href)
  return /^[a-z]+:\/\//i.test(text) ? new URL(text) : (await ofSystem()).urlOfPath(text)
}

export function nameOf(url) {
  const name = url.pathname.split('/').pop() || 'scene'
  try {
    return decodeURIComponent(name)
  } catch {
    return name
  }
}

async function answerOf(name, url, watch, begun) {
  const answer = await watch.wait(begun ?? fetched(name, url, { signal: watch.request.signal })).catch((cause) => {
    if (watch.failure || cause?.isLasting) throw cause
    const words = 'cannot be reached. Is the address right, and does its server allow other pages to read it?'
    throw new Error(`${name}: ${words}`, { cause })
  })
  if (answer.status === 404) throw new Error(`${name}: there is no such file at this address (404)`)
  if (!answer.ok) throw new Error(`${name}: the server answered ${answer.status} ${answer.statusText}`)
  return answer
}

/** Downloads a file. came(file, share) is called after each arrived part, and the download waits for the promise that
    it returns. `share` is the downloaded share; undefined if the size is unknown. `begun` is the promise of an answer
    that was requested earlier. */
export async function download(url, options, came = () => {}, begun) {
  const name = nameOf(url)
  const watch = new Watch(name, options)
  try {
    const answer = await answerOf(name, url, watch, begun)
    const total = answer.headers.get('content-encoding') ? 0 : Number(answer.headers.get('content-length'))
    const file = new SourceFile(name, total, options.most)
    await fill(file, answer.body.getReader(), watch, came)
    return file
  } finally {
    watch.end()
  }
}

async function fill(file, reader, watch, came) {
  const next = () =>
    watch.wait(reader.read()).catch((cause) => {
      if (watch.failure) throw watch.failure
      throw new Error(`${file.name}: the download broke off after ${file.there} bytes`, { cause })
    })
  try {
    for (let part = await next(); !part.done; part = await next()) {
      file.add(part.value)
      watch.heard(part.value.length)
      await came(file, file.total ? file.there / file.total : undefined)
    }
  } catch (error) {
    reader.cancel().catch(() => {})
    throw error
  }
}

async function fromUrl(url, options, came, { begun, first } = {}) {
  if (!inNode || url.protocol !== 'file:') return download(url, options, came, begun)
  const system = await ofSystem()
  return SourceFile.of(nameOf(url), await (first ? system.readWithin(first, url) : system.readFile(url)))
}

async function fromBlob(blob) {
  const file = new SourceFile(blob.name ?? 'scene', blob.size)
  return SourceFile.of(file.name, new Uint8Array(await blob.arrayBuffer()))
}

// ---- Files of a scene -----------------------------------------------------------------------------------------

const INDEX = /(^|\/)(tileset\.json|lod-meta\.json|meta\.json|[^/]*\.(gltf|lcc))$/i
const isBlob = (source) => typeof Blob === 'function' && source instanceof Blob
const pathOf = (file) => file.webkitRelativePath || file.name

const decoded = (name) => name.replace(/%([0-9a-f]{2})/gi, (_, code) => String.fromCharCode(parseInt(code, 16)))

/** Returns true if a file name leads to a file in the scene's folder or below, like fxs_name_stays in C. A foreign
    scene must not read files elsewhere. */
export const staysInside = (name) =>
  !/^$|^[\\/]|^[a-z][a-z0-9+.-]*:|(^|[\\/])\.\.([\\/]|$)|[\0-\x1f]/i.test(decoded(name))

export class Files {
  #files = new Map()
  #asked = new Set()
  #coming = new Map()
  #options
  #beside = async () => undefined

  constructor(options = {}) {
    this.#options = options
  }

  async open(source, came, begun) {
    const first = await this.#first(source, came, begun)
    this.#files.set(first.name, first)
    return first
  }

  async #first(source, came, begun) {
    if (source instanceof ArrayBuffer) return SourceFile.of('scene', new Uint8Array(source))
    if (ArrayBuffer.isView(source))
      return SourceFile.of('scene', new Uint8Array(source.buffer, source.byteOffset, source.byteLength))
    if (isBlob(source)) return fromBlob(source)
    if (typeof source === 'object' && typeof source?.[Symbol.iterator] === 'function') return this.#list([...source])
    const address = source?.href ?? source
    if (typeof address !== 'string') throw new Error('load: expected an address, bytes, a Blob or a list of files')
    const url = source instanceof URL ? source : await urlOf(address)
    this.#beside = async (name) => {
      const beside = new URL(name.split('/').map(encodeURIComponent).join('/'), url)
      return fromUrl(beside, this.#options, (file) => this.#tell(name, file), { first: url })
    }
    return fromUrl(url, this.#options, (file, share) => {
      this.#files.set(file.name, file)
      return came(file, share)
    }, { begun })
  }

  async #list(list) {
    if (!list.length || !list.every(isBlob)) throw new Error('no files')
    list.sort((a, b) => pathOf(a).split('/').length - pathOf(b).split('/').length)
    const first = list.find((file) => INDEX.test(pathOf(file))) ?? list[0]
    const folder = pathOf(first).replace(/[^/]*$/, '')
    this.#beside = async (name) => fromBlob(list.find((file) => pathOf(file) === folder + name))
    return fromBlob(first)
  }

  #tell(name, file) {
    this.#coming.set(name, file.there)
    const bytes = [...this.#coming.values()].reduce((sum, there) => sum + there, this.all[0].there)
    if (bytes > MOST_ALL) throw this.all[0].tooLarge(bytes, MOST_ALL)
    this.#options.progress?.({ stage: 'download', bytes })
  }

  get all() {
    return [...this.#files.values()]
  }

  numberOf(name) {
    return [...this.#files.keys()].indexOf(name)
  }

  async ask(names) {
    const isNew = (name) => !this.#asked.has(name) && staysInside(name)
    const asked = new Set([...names].flatMap((name) => this.#andNext(name)).filter(isNew))
    const one = async (name) => {
      this.#asked.add(name)
      const file = await this.#beside(name).catch((error) => {
        if (error?.isSlow || error?.isLarge || error?.isLasting || this.#options.signal?.aborted) throw error
      })
      if (file) this.#files.set(name, file)
    }
    await Promise.all([...asked].map(one))
    return asked.size > 0
  }

  #andNext(name) {
    const [kind] = name.match(/[^./]*$/)
    for (const [index, file] of this.#files) {
      // skips files that do not begin with an opening brace, since index files are JSON
      if (file.there > 1e6 || file.first(1)[0] !== 0x7b) continue
      const folder = index.replace(/[^/]*$/, '')
      const texts = new TextDecoder().decode(file.first(file.there)).match(/"[^"\\]*"/g) ?? []
      const isOfKind = (text) => text.endsWith(`.${kind}`) && staysInside(text)
      const names = texts.map((text) => text.slice(1, -1)).filter(isOfKind).map((text) => folder + text)
      if (names.includes(name)) return names.slice(names.indexOf(name)).slice(0, AT_ONCE)
    }
    return [name]
  }
}
