// Sends requests to the worker (worker.js), and returns promises of its answers. Ending the worker frees all of its
// memory.
import { assets, folderOf, hasStart, startWorker } from 'fixsplat/fixsplat_assets.js'

const WORKER = 'viewer/worker.js'

/** The folder of the viewer's files in a page without a bundler; undefined with a bundler. */
export const HOME = hasStart(WORKER) ? undefined : folderOf(import.meta.url, 'engine.js')

const moved = (value) => {
  if (globalThis.OffscreenCanvas && value instanceof OffscreenCanvas) return [value]
  return value instanceof Uint8Array ? [value.buffer] : []
}

const NO_WORKER = 'The script of the renderer cannot be loaded: where a bundler has made this page, see Bundlers in the ' +
  'README of fixsplat-viewer; else this browser is too old'

export class Engine {
  #waiting = new Map()
  #ended = ''
  #next = 0

  constructor(hear, threads) {
    this.threads = threads
    this.worker = startWorker(WORKER, HOME)
    this.worker.onmessage = ({ data }) => (data.stage ? hear(data) : this.#settle(data))
    this.worker.onerror = (event) => this.end(event.message || NO_WORKER)
    if (assets()) this.ask('assets', assets()).catch(() => {})
  }

  open(key, source, place = {}, previews = false) {
    return this.ask('open', key, source, place, { threads: this.threads, previews })
  }

  ask(word, ...args) {
    return new Promise((resolve, reject) => {
      if (this.#ended) throw new Error(this.#ended)
      this.#waiting.set(this.#next, { resolve, reject })
      this.worker.postMessage({ id: this.#next++, word, args }, args.flatMap(moved))
    })
  }

  end(words = 'the scene was closed') {
    this.worker.terminate()
    this.#ended = words
    for (const { reject } of this.#waiting.values()) reject(new Error(words))
    this.#waiting.clear()
  }

  #settle({ id, result, error }) {
    const { resolve, reject } = this.#waiting.get(id)
    this.#waiting.delete(id)
    if (error === undefined) resolve(result)
    else reject(new Error(error))
  }
}
