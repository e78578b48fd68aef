// Scenes that are loaded and drawn in a worker of their own. Each request to the worker returns a promise. When the
// worker ends, all of its memory is freed.

/** What goes to the worker and is not copied. */
const moved = (value) => {
  if (globalThis.OffscreenCanvas && value instanceof OffscreenCanvas) return [value]
  return value instanceof Uint8Array ? [value.buffer] : []
}

export class Engine {
  #waiting = new Map()
  #ended = ''
  #next = 0

  /** `hear` is told what the worker says by itself; without a number of threads there are as many as processors. */
  constructor(hear, threads) {
    this.threads = threads
    this.worker = new Worker(new URL('./worker.js', import.meta.url), { type: 'module' })
    this.worker.onmessage = ({ data }) => (data.stage ? hear(data) : this.#settle(data))
    this.worker.onerror = (event) => this.end(event.message || 'this browser cannot run the renderer')
  }

  /** A File, a list of them, bytes or an address, by the key of the scene, and its place; `previews` where the worker
      is to tell of parts that have come. */
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
