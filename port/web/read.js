// Reads the files of a scene, from addresses, from files of the machine or from memory. A scene file may name other
// files, which are read too.

import { inNode, ofSystem } from './fixsplat_assets.js'

const MOST = 2e9               // bytes of a file
const AT_ONCE = 16             // files beside, asked for before they are wanted

/** The bytes of a file, of which `there` have come: `bytes` has room for those that are known to come. */
class SourceFile {
  constructor(name, bytes, there = bytes.length) {
    Object.assign(this, { name, bytes, there })
    if (bytes.length > MOST) throw this.tooLarge(bytes.length)
  }

  tooLarge(bytes) {
    return new Error(`${this.name}: ${(bytes / 1e9).toFixed(1)} GB, and no more than ${MOST / 1e9} GB can be read`)
  }

  add(part) {
    const there = this.there + part.length
    if (there > MOST) throw this.tooLarge(there)
    if (there > this.bytes.length) {
      const larger = new Uint8Array(Math.max(there, Math.min(MOST, 2 * this.bytes.length)))
      larger.set(this.bytes.subarray(0, this.there))
      this.bytes = larger
    }
    this.bytes.set(part, this.there)
    this.there = there
  }

  get isPacked() {
    return this.there >= 4 && String.fromCharCode(...this.bytes.subarray(0, 4)) === 'FXS1'
  }
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
    return name                 // a per cent sign that escapes nothing
  }
}

async function answerOf(name, url, begun = fetch(url)) {
  const answer = await begun.catch((cause) => {
    const words = 'cannot be reached. Is the address right, and does its server allow other pages to read it?'
    throw new Error(`${name}: ${words}`, { cause })
  })
  if (answer.status === 404) throw new Error(`${name}: there is no such file at this address (404)`)
  if (!answer.ok) throw new Error(`${name}: the server answered ${answer.status} ${answer.statusText}`)
  return answer
}

/** `came` hears of each part, with the share of the whole that has come, where the server says how much that is.
    `begun`: the answer, where there is one already. */
async function download(name, url, came, begun) {
  const answer = await answerOf(name, url, begun)
  const total = answer.headers.get('content-encoding') ? 0 : Number(answer.headers.get('content-length'))
  if (total > MOST) throw new SourceFile(name, []).tooLarge(total)
  const file = new SourceFile(name, new Uint8Array(total || 65536), 0)
  const reader = answer.body.getReader()
  const next = () =>
    reader.read().catch((cause) => {
      throw new Error(`${name}: the download broke off after ${file.there} bytes`, { cause })
    })
  try {
    for (let part = await next(); !part.done; part = await next()) {
      file.add(part.value)
      await came(file, total ? file.there / total : undefined)
    }
  } catch (error) {
    reader.cancel().catch(() => {})
    throw error
  }
  file.bytes = file.bytes.subarray(0, file.there)
  return file
}

async function fromUrl(url, came, begun) {
  if (!inNode || url.protocol !== 'file:') return download(nameOf(url), url, came, begun)
  return new SourceFile(nameOf(url), await (await ofSystem()).readFile(url))
}

async function fromBlob(blob) {
  const name = blob.name ?? 'scene'
  if (blob.size > MOST) throw new SourceFile(name, []).tooLarge(blob.size)
  return new SourceFile(name, new Uint8Array(await blob.arrayBuffer()))
}

// ---- A scene's files ------------------------------------------------------------------------------------------

const INDEX = /(^|\/)(tileset\.json|lod-meta\.json|meta\.json|[^/]*\.(gltf|lcc))$/i
const isBlob = (source) => typeof Blob === 'function' && source instanceof Blob
const pathOf = (file) => file.webkitRelativePath || file.name

/** The files of a scene by their names from the folder of the first, which is the one that is opened. */
export class Files {
  #files = new Map()
  #asked = new Set()
  #beside = async () => undefined

  /** Opens whatever `load` takes. */
  async open(source, came, begun) {
    const first = await this.#first(source, came, begun)
    this.#files.set(first.name, first)
    return first
  }

  async #first(source, came, begun) {
    if (source instanceof ArrayBuffer) return new SourceFile('scene', new Uint8Array(source))
    if (ArrayBuffer.isView(source))
      return new SourceFile('scene', new Uint8Array(source.buffer, source.byteOffset, source.byteLength))
    if (isBlob(source)) return fromBlob(source)
    if (typeof source === 'object' && typeof source?.[Symbol.iterator] === 'function') return this.#list([...source])
    const url = source instanceof URL ? source : await urlOf(String(source))
    this.#beside = (name) => fromUrl(new URL(name.split('/').map(encodeURIComponent).join('/'), url), () => {})
    return fromUrl(url, (file, share) => {
      this.#files.set(file.name, file)
      return came(file, share)
    }, begun)
  }

  /** Of files, that which names the others. */
  async #list(list) {
    if (!list.length || !list.every(isBlob)) throw new Error('no files')
    list.sort((a, b) => pathOf(a).split('/').length - pathOf(b).split('/').length)
    const first = list.find((file) => INDEX.test(pathOf(file))) ?? list[0]
    const folder = pathOf(first).replace(/[^/]*$/, '')
    this.#beside = async (name) => fromBlob(list.find((file) => pathOf(file) === folder + name))
    return fromBlob(first)
  }

  get all() {
    return [...this.#files.values()]
  }

  numberOf(name) {
    return [...this.#files.keys()].indexOf(name)
  }

  /** Asks for files beside the first, where that was not done yet. False where there is nothing to ask for. */
  async ask(names) {
    const asked = new Set([...names].flatMap((name) => this.#andNext(name)).filter((name) => !this.#asked.has(name)))
    const one = async (name) => {
      this.#asked.add(name)
      const file = await this.#beside(name).catch(() => undefined)
      if (file) this.#files.set(name, file)
    }
    await Promise.all([...asked].map(one))
    return asked.size > 0
  }

  /** A name, and those of its kind that follow it in an index. */
  #andNext(name) {
    const [kind] = name.match(/[^./]*$/)
    for (const [index, file] of this.#files) {
      if (file.bytes[0] !== 0x7b || file.bytes.length > 1e6) continue   // {
      const folder = index.replace(/[^/]*$/, '')
      const texts = new TextDecoder().decode(file.bytes).match(/"[^"\\]*"/g) ?? []
      const names = texts.map((text) => folder + text.slice(1, -1)).filter((text) => text.endsWith(`.${kind}`))
      if (names.includes(name)) return names.slice(names.indexOf(name)).slice(0, AT_ONCE)
    }
    return [name]
  }
}
