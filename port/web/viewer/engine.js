// A scene in a worker of its own: what is asked of it is a promise; its end gives all of its memory back.

export class Engine {
  #waiting = new Map()
  #next = 0

  constructor(progress) {
    this.worker = new Worker(new URL('./worker.js', import.meta.url), { type: 'module' })
    this.worker.onmessage = ({ data }) => (data.stage ? progress(data) : this.#settle(data))
    this.worker.onerror = (event) => this.#fail(event.message || 'this browser cannot run the renderer')
  }

  ask(word, ...args) {
    return new Promise((resolve, reject) => {
      this.#waiting.set(this.#next, { resolve, reject })
      this.worker.postMessage({ id: this.#next++, word, args })
    })
  }

  end() {
    this.worker.terminate()
    this.#waiting.clear()
  }

  #settle({ id, result, error }) {
    const { resolve, reject } = this.#waiting.get(id)
    this.#waiting.delete(id)
    if (error === undefined) resolve(result)
    else reject(new Error(error))
  }

  #fail(words) {
    for (const { reject } of this.#waiting.values()) reject(new Error(words))
    this.#waiting.clear()
  }
}
