// Scenes with levels of detail that are not downloaded: the tables of the file come first, then the rows of those
// chunks that pictures want, into a pool of bounded size. web_paged.c has the same from the side of the module.

import { fetched, later, Watch } from './read.js'
import { Store } from './store.js'

const HEADER = 192              // bytes of the file's header, and of a chunk's
const CHUNK_HEADER = 128
const GAUSSIANS = 256           // of a chunk
const NOTHING = 2 ** 32 - 1
const TOP = 64                  // nodes whose rows are there before the first picture, and stay
const BLOCK = 2048              // headers of chunks that come together
const PIECE = 1 << 20           // bytes of the tree that come together,
const RUN = 1 << 19             // and of rows, with gaps of at most
const GAP = 1 << 15
const AT_ONCE = 6               // requests
const MEMORY = 512e6            // bytes of the pool
const LEAST_PLACES = 256        // of chunks in it
const BUDGET = 1e6              // Gaussians of a picture where nothing is asked for
const TRIES = 5                 // of a request, two where the server is slow, with pauses that grow from
const PAUSE = 100
const AGAIN = 5000              // milliseconds after a failure that may pass, until a picture's wants are tried again
const TELL = 50                 // milliseconds between two words about what has come

const pause = (milliseconds) => new Promise((done) => setTimeout(done, milliseconds))

/** An Error after which no request makes sense any more. */
const lasting = (words) => Object.assign(new Error(words), { isLasting: true })

// ---- The server -----------------------------------------------------------------------------------------------

/** Ranges of a file on a server, which must not change meanwhile. */
class Remote {
  #url
  #options
  #tag
  #modified
  #running = new Set()
  #ended = false

  /** `options`: those of a Watch. */
  constructor(url, name, { silence, signal }) {
    Object.assign(this, { name })
    this.#url = url
    this.#options = { silence, signal }
  }

  /** From now on requests end by `end` alone. */
  opened() {
    this.#options.signal = undefined
  }

  /** What the file is known by; empty where the server does not say. */
  get version() {
    return this.#tag ?? this.#modified ?? ''
  }

  /** The first bytes, or an answer that is the whole file, or nothing where the server does not answer ranges. */
  async begin(length) {
    return this.#guarded(async (watch) => {
      const answer = await this.#fetch(0, length, {}, watch).catch((error) => {
        if (error?.isLasting) throw error
      })
      if (watch.failure) throw watch.failure
      if (answer?.status !== 206 || answer.headers.get('content-encoding')) {
        if (answer?.ok && answer.status !== 206) return { answer, whole: true }
        answer?.body?.cancel().catch(() => {})
        return {}
      }
      this.#tag = answer.headers.get('etag') ?? undefined
      this.#modified = answer.headers.get('last-modified') ?? undefined
      const bytes = await this.#bytesOf(answer, 0, length, watch).catch(() => null)
      if (watch.failure) throw watch.failure
      const total = Number(answer.headers.get('content-range')?.match(/\/(\d+)$/)?.[1] ?? NaN)
      return bytes ? { bytes, total } : {}
    })
  }

  /** Bytes first to end - 1, tried several times. `came` hears how many there are so far. */
  async read(first, end, came) {
    for (let i = 1; ; i++)
      try {
        return await this.#guarded((watch) => this.#ask(first, end, watch, came))
      } catch (error) {
        const isOver = this.#ended || this.#options.signal?.aborted || error.isLasting
        if (isOver || i === (error.isSlow ? 2 : TRIES)) throw error
        await pause(PAUSE * 2 ** i)
      }
  }

  end() {
    this.#ended = true
    for (const abort of this.#running) abort.abort()
  }

  async #guarded(run) {
    if (this.#ended) throw lasting(`${this.name}: was freed`)
    const watch = new Watch(this.name, this.#options)
    this.#running.add(watch.request)
    try {
      return await run(watch)
    } finally {
      watch.end()
      this.#running.delete(watch.request)
    }
  }

  #fetch(first, end, headers, watch) {
    const options = { headers: { range: `bytes=${first}-${end - 1}`, ...headers }, cache: 'no-store' }
    return watch.wait(fetched(this.name, this.#url, { ...options, signal: watch.request.signal }))
  }

  async #ask(first, end, watch, came) {
    // Other servers would have to allow the header, and weak tags are none.
    const isOwn = !globalThis.location || globalThis.location.origin === this.#url.origin
    const same = isOwn && this.#tag?.startsWith('"') ? { 'if-range': this.#tag } : {}
    const answer = await this.#fetch(first, end, same, watch).catch((cause) => {
      if (watch.failure || cause?.isLasting) throw cause
      throw new Error(`${this.name}: the server cannot be reached any more`, { cause })
    })
    if (answer.status !== 206) {
      answer.body?.cancel().catch(() => {})
      throw this.#refusal(answer)
    }
    const isOther = (name, known) => known && (answer.headers.get(name) ?? known) !== known
    if (isOther('etag', this.#tag) || isOther('last-modified', this.#modified)) {
      answer.body?.cancel().catch(() => {})
      throw this.#changed()
    }
    return this.#bytesOf(answer, first, end, watch, came)
  }

  #changed() {
    return lasting(`${this.name}: has changed on its server since it was opened: open it again`)
  }

  #refusal({ status, statusText }) {
    if (status === 200 || status === 412 || status === 416) return this.#changed()
    const words = `${this.name}: the server answered ${status} ${statusText}`
    return status === 408 || status === 429 || status >= 500 ? new Error(words) : lasting(words)
  }

  async #bytesOf(answer, first, end, watch, came) {
    const said = answer.headers.get('content-range')
    if (said && !said.startsWith(`bytes ${first}-${end - 1}/`)) {
      answer.body?.cancel().catch(() => {})
      throw lasting(`${this.name}: the server answered with other bytes than it was asked for`)
    }
    const bytes = new Uint8Array(end - first)
    const reader = answer.body.getReader()
    let there = 0
    for (;;) {
      const { done, value } = await watch.wait(reader.read()).catch((cause) => {
        throw watch.failure ?? new Error(`${this.name}: an answer broke off`, { cause })
      })
      if (done) break
      watch.heard(value.length)
      if (there + value.length > bytes.length) {
        reader.cancel().catch(() => {})
        throw lasting(`${this.name}: the server answered with more bytes than it was asked for`)
      }
      bytes.set(value, there)
      there += value.length
      came?.(there)
    }
    if (there < bytes.length) throw new Error(`${this.name}: an answer broke off`)
    return bytes
  }
}

// ---- The scene ------------------------------------------------------------------------------------------------

/** The chunks of a scene in a module: which are there, which are to come, and where they go. */
export class Pager {
  #core
  #at
  #remote
  #store
  #text                         // the name, in the module
  #layout
  #places
  #used = 0                     // places in the pool
  #spare = []
  #victims = []
  #fullAt = -1
  #chunkOf
  #now = new Uint32Array(0)     // what the last picture lacks, what is needed most first
  #wanted = this.#now           // and then what lies ahead of it
  #cursor = 0
  #marks                        // of each chunk, the last list that it was in
  #mark = 0
  #turn = 0
  #busy = new Set()             // chunks that are on their way
  #blocks                       // of headers: 0 is not there, 1 on its way, 2 there
  #pendingBlocks = 0
  #headersRunning = 0
  #running = 0
  #most
  #waiting = []
  #changed
  #told = 0
  #timer
  #ended = false
  failure = null

  constructor(core, remote, store, { changed, requests = AT_ONCE }) {
    this.#core = core
    this.#remote = remote
    this.#store = store
    this.#changed = changed
    this.#most = requests
    this.#text = core.copyText(remote.name)
  }

  // ---- Opening ----

  /** Takes the header, and fetches what the first picture needs. Returns the place of the scene in the module. */
  async open(header, total, { memory = MEMORY, progress }) {
    const core = this.#core
    this.#allocate(header, total, memory)
    const { leaves, chunkBytes, palette, tree, nodeHeaders, nodeRows } = this.#layout
    const top = Math.min(TOP, leaves - 1)
    const block = Math.min(BLOCK, leaves - 1)
    const parts = [
      { ...palette },
      { ...nodeHeaders, bytes: block * CHUNK_HEADER },
      { at: this.#layout.pool, from: nodeRows, bytes: top * chunkBytes },
    ]
    for (let at = 0; at < tree.bytes; at += PIECE)
      parts.push({ at: tree.at + at, from: tree.from + at, bytes: Math.min(PIECE, tree.bytes - at) })
    const all = parts.reduce((sum, { bytes }) => sum + bytes, 0)
    let there = 0
    const one = async ({ at, from, bytes }) => {
      let own = 0
      const came = (now) => {
        there += now - own
        own = now
        progress?.({ stage: 'download', done: there / all, bytes: there })
      }
      if (bytes) this.#put(at, await this.#read(from, from + bytes, came))
      came(bytes)
    }
    await Promise.all(Array.from({ length: this.#most }, async () => {
      for (let part; (part = parts.shift()); ) await one(part)
    }))
    core.check(core.c.paged_spread(this.#at, this.#text, block))
    const facts = core.get(0, 10)
    for (let i = 0; i < top; i++) this.#take(leaves + i, i)
    this.#used = top
    core.check(core.c.paged_headers(this.#at, this.#text, leaves, leaves + block))
    core.check(core.c.paged_rows(this.#at, this.#text, leaves, leaves + top))
    core.check(core.c.paged_coarse(this.#at, top))
    this.#blocks[0] = 2
    this.#pendingBlocks--
    return { at: this.#at, facts }
  }

  /** The pool is halved until there is room for it. */
  #allocate(header, total, memory) {
    const core = this.#core
    const at = core.copy(header)
    try {
      const hasTree = core.check(core.c.paged_header(this.#text, at))
      const [bytes, chunkBytes, chunks] = core.get(0, 3)
      if (!hasTree || total < bytes)
        throw lasting(`${this.#remote.name}: damaged or cut short: ${total} bytes, expected ${bytes}`)
      this.bytes = bytes
      const least = Math.min(chunks, LEAST_PLACES)
      let places = Math.max(Math.min(chunks, Math.floor(memory / chunkBytes)), least)
      while (!(this.#at = core.c.paged_open(at, places) >>> 0) && places > least) places = Math.max(places >> 1, least)
      if (!this.#at) throw lasting(`${this.#remote.name}: too little memory for the tables of ${chunks} parts`)
      this.#layOut(core.get(0, 19), places, chunkBytes, chunks)
    } finally {
      core.c.release(at)
    }
  }

  #layOut(numbers, places, chunkBytes, chunks) {
    const part = (i) => ({ at: numbers[i], from: numbers[i + 1], bytes: numbers[i + 2] })
    const [leafRows, nodeRows, pool, where, stamps, wanted] = numbers.slice(13)
    const [palette, tree, nodeHeaders, leafHeaders] = [1, 4, 7, 10].map(part)
    const leaves = numbers[0]
    this.#layout = { leaves, chunks, chunkBytes, palette, tree, nodeHeaders, leafHeaders, leafRows, nodeRows, pool }
    Object.assign(this.#layout, { where, stamps, wanted })
    this.#places = places
    this.#chunkOf = new Uint32Array(places)
    this.#marks = new Uint32Array(chunks)
    this.nodeBlocks = Math.ceil((leaves - 1) / BLOCK)
    this.#blocks = new Uint8Array(this.nodeBlocks + Math.ceil(leaves / BLOCK))
    this.#pendingBlocks = this.#blocks.length
  }

  // ---- What frames want ----

  /** The Gaussians that a picture has at most where nobody says: 0 where there is no limit. */
  get budget() {
    return this.#layout.chunks <= Math.min(this.#places, BUDGET / GAUSSIANS) ? 0 : Math.min(BUDGET, this.most)
  }

  /** The most that a picture may have, as what is coarser has to be there too meanwhile. */
  get most() {
    if (this.#places >= this.#layout.chunks) return Infinity
    return ((this.#places - TOP) >> 1) * GAUSSIANS
  }

  /** What is to come beside chunks that a picture lacks: their headers are not known. */
  get pending() {
    return this.#pendingBlocks
  }

  /** After a picture, or after a look `ahead`. */
  looked(ahead) {
    const count = this.#core.c.paged_wanted(this.#at)
    this.#turn = this.#core.c.paged_turn(this.#at)
    const list = this.#words(this.#layout.wanted, count)
    this.lacking = count
    if (!ahead) {
      this.#now = list.slice()
      this.#mark++
    }
    this.#wanted = new Uint32Array(this.#now.length + (ahead ? count : 0))
    this.#wanted.set(this.#now)
    if (ahead) this.#wanted.set(list, this.#now.length)
    for (const chunk of list) this.#marks[chunk] = this.#mark
    this.#cursor = 0
    const isOver = this.failure && !this.failure.isLasting && performance.now() - this.failedAt > AGAIN
    if (isOver) this.failure = null
    this.#fetch()
  }

  /** Fulfilled when something has come; rejected where nothing more will. */
  arrival() {
    if (this.failure) return Promise.reject(this.failure)
    if (!this.#running) {
      const words = `${this.#remote.name}: the pool has no room for this picture: a larger paging.memory has`
      return Promise.reject(new Error(words))
    }
    return new Promise((resolve, reject) => this.#waiting.push({ resolve, reject }))
  }

  /** Gives everything back; the remote file can go on with another pager. */
  close() {
    this.#ended = true
    clearTimeout(this.#timer)
    if (this.#at) this.#core.c.paged_close(this.#at)
    this.#core.c.release(this.#text)
    this.#at = 0
    this.#settle(lasting(`${this.#remote.name}: was freed`))
  }

  end() {
    this.close()
    this.#remote.end()
  }

  // ---- Fetching ----

  #fetch() {
    while (this.#running < this.#most && !this.failure && !this.#ended) {
      const job = this.#next()
      if (!job) return
      this.#running++
      job().then(() => this.#came(), (error) => this.#fail(error)).finally(() => {
        this.#running--
        this.#fetch()
        if (!this.#running) this.#settle()
      })
    }
  }

  /** One request in turn is for headers until all are there; chunks that are wanted come before the other headers. */
  #next() {
    if (this.#pendingBlocks && !this.#headersRunning) {
      const job = this.#nextBlock()
      if (job) return job
    }
    while (this.#cursor < this.#wanted.length) {
      const chunk = this.#wanted[this.#cursor++]
      const block = this.#blockOf(chunk)
      if (this.#isThere(chunk) || this.#busy.has(chunk) || this.#blocks[block] === 1) continue
      if (!this.#blocks[block]) return this.#jobOfBlock(block)
      if (!this.#hasRoom()) break
      return this.#jobOfRows(chunk)
    }
    return this.#nextBlock()
  }

  #nextBlock() {
    const block = this.#blocks.indexOf(0)
    return block < 0 ? null : this.#jobOfBlock(block)
  }

  #blockOf(chunk) {
    const { leaves } = this.#layout
    return chunk < leaves ? this.nodeBlocks + Math.floor(chunk / BLOCK) : Math.floor((chunk - leaves) / BLOCK)
  }

  #jobOfBlock(block) {
    const { leaves, nodeHeaders, leafHeaders } = this.#layout
    const isLeaf = block >= this.nodeBlocks
    const part = isLeaf ? leafHeaders : nodeHeaders
    const first = (isLeaf ? block - this.nodeBlocks : block) * BLOCK
    const count = Math.min(BLOCK, (isLeaf ? leaves : leaves - 1) - first)
    const number = first + (isLeaf ? 0 : leaves)
    this.#blocks[block] = 1
    this.#headersRunning++
    return async () => {
      try {
        await this.#readChecked(part.from + first * CHUNK_HEADER, count * CHUNK_HEADER, (bytes) => {
          this.#put(part.at + first * CHUNK_HEADER, bytes)
          this.#check('paged_headers', number, number + count)
        })
        this.#blocks[block] = 2
        this.#pendingBlocks--
        this.#cursor = 0
      } finally {
        this.#headersRunning--
        if (this.#blocks[block] === 1) this.#blocks[block] = 0
      }
    }
  }

  /** A chunk with its neighbours that are wanted too, as the cache has them or as one request. */
  #jobOfRows(chunk) {
    const { leaves, chunks, chunkBytes, leafRows, nodeRows } = this.#layout
    const isLeaf = chunk < leaves
    const [low, high, rows] = isLeaf ? [0, leaves, leafRows] : [leaves, chunks, nodeRows]
    const kept = this.#store?.find(rows + (chunk - low) * chunkBytes)
    const [first, end] = kept
      ? kept.map((byte) => low + (byte - rows) / chunkBytes)
      : this.#runAround(chunk, low, high)
    for (let i = first; i < end; i++) this.#busy.add(i)
    return async () => {
      try {
        const bytes = (end - first) * chunkBytes
        await this.#readChecked(rows + (first - low) * chunkBytes, bytes, (all) => this.#takeAll(first, end, all))
      } finally {
        for (let i = first; i < end; i++) this.#busy.delete(i)
      }
    }
  }

  #runAround(chunk, low, high) {
    const { chunkBytes } = this.#layout
    const most = Math.max(Math.floor(RUN / chunkBytes), 1)
    const gap = Math.floor(GAP / chunkBytes) + 1
    const lacks = (i) =>
      this.#marks[i] === this.#mark && !this.#isThere(i) && !this.#busy.has(i) && this.#blocks[this.#blockOf(i)] === 2
    let [first, last] = [chunk, chunk]
    for (let i = chunk + 1; i < Math.min(high, last + 1 + gap, first + most); i++) if (lacks(i)) last = i
    for (let i = chunk - 1; i >= Math.max(low, first - gap, last + 1 - most); i--) if (lacks(i)) first = i
    return [first, last + 1]
  }

  /** What the cache has or the server answers; where it is damaged, once more what the server answers. */
  async #readChecked(first, length, take) {
    for (let i = 0; ; i++) {
      const bytes = await this.#read(first, first + length)
      if (this.#ended) return
      try {
        return take(bytes)
      } catch (error) {
        await this.#store?.drop(first, first + length)
        if (!i) continue
        this.#store?.clear()
        throw lasting(error.message)
      }
    }
  }

  async #read(first, end, came) {
    const kept = await this.#store?.get(first, end)
    if (kept) return kept
    const bytes = await this.#remote.read(first, end, came)
    this.#store?.put(first, end, bytes)
    return bytes
  }

  // ---- What has come ----

  #words(at, count) {
    return new Uint32Array(this.#core.c.memory.buffer, at, count)
  }

  #put(at, bytes) {
    if (!this.#ended) this.#core.bytes(at, bytes.length).set(bytes)
  }

  #check(name, first, end) {
    this.#core.check(this.#core.c[name](this.#at, this.#text, first, end))
  }

  #isThere(chunk) {
    return this.#words(this.#layout.where, this.#layout.chunks)[chunk] !== NOTHING
  }

  #take(chunk, place) {
    this.#words(this.#layout.where, this.#layout.chunks)[chunk] = place
    this.#words(this.#layout.stamps, this.#places)[place] = this.#turn
    this.#chunkOf[place] = chunk
  }

  /** Rows of neighbours: each gets a place, where there is one; those that nobody wants only where one is free. */
  #takeAll(first, end, bytes) {
    const { chunkBytes, pool, where, chunks } = this.#layout
    const taken = []
    for (let chunk = first; chunk < end; chunk++) {
      if (this.#isThere(chunk) || this.#blocks[this.#blockOf(chunk)] !== 2) continue
      const place = this.#placeFor(chunk)
      if (place < 0) continue
      const at = (chunk - first) * chunkBytes
      this.#put(pool + place * chunkBytes, bytes.subarray(at, at + chunkBytes))
      this.#take(chunk, place)
      taken.push(chunk)
    }
    try {
      for (let i = 0, from = 0; i < taken.length; i++)
        if (taken[i + 1] !== taken[i] + 1) {
          this.#check('paged_rows', taken[from], taken[i] + 1)
          from = i + 1
        }
    } catch (error) {
      const places = this.#words(where, chunks)
      for (const chunk of taken) {
        this.#spare.push(places[chunk])
        places[chunk] = NOTHING
      }
      throw error
    }
  }

  /** A free place in the pool, or that of the chunk that was wanted longest ago; -1 where all are in use. */
  #placeFor(chunk) {
    if (this.#spare.length) return this.#spare.pop()
    if (this.#used < this.#places) return this.#used++
    if (this.#marks[chunk] !== this.#mark || !this.#hasRoom()) return -1
    const place = this.#victims.pop()
    this.#words(this.#layout.where, this.#layout.chunks)[this.#chunkOf[place]] = NOTHING
    return place
  }

  #hasRoom() {
    if (this.#spare.length || this.#used < this.#places) return true
    const stamps = this.#words(this.#layout.stamps, this.#places)
    while (this.#victims.length && stamps[this.#victims.at(-1)] >= this.#turn - 1) this.#victims.pop()
    if (this.#victims.length) return true
    if (this.#fullAt === this.#turn) return false
    this.#fullAt = this.#turn
    this.#victims = this.#oldest(stamps)
    return this.#victims.length > 0
  }

  /** Places that neither the last picture nor the last look ahead used, the oldest last. */
  #oldest(stamps) {
    const keys = new Float64Array(this.#places)
    let count = 0
    for (let place = TOP; place < this.#places; place++)
      if (stamps[place] < this.#turn - 1) keys[count++] = stamps[place] * 2 ** 21 + place
    const sorted = keys.subarray(0, count).sort().subarray(0, Math.max(this.#places >> 3, 1))
    return Array.from(sorted, (key) => key % 2 ** 21).reverse()
  }

  // ---- Telling ----

  #came() {
    this.#settle()
    if (this.#ended || this.#timer) return
    const wait = Math.max(TELL - (performance.now() - this.#told), 0)
    this.#timer = later(() => {
      this.#timer = undefined
      this.#told = performance.now()
      this.#changed?.()
    }, wait)
  }

  #fail(error) {
    if (this.#ended || this.failure) return
    this.failure = error
    this.failedAt = performance.now()
    this.#settle(error)
    this.#changed?.(error)
  }

  #settle(error) {
    const waiting = this.#waiting
    this.#waiting = []
    for (const { resolve, reject } of waiting) error ? reject(error) : resolve()
  }
}

/** Opens a file for paging: a pager with the place of its scene and facts; or an answer that has the whole file; or
    nothing, where it cannot be read in ranges, or has no levels of detail. */
export async function openPaged(url, name, coreOf, { paging, progress, silence, signal }) {
  const options = { silence, ...paging, progress, signal }
  const remote = new Remote(url, name, options)
  const { bytes, total, answer } = await remote.begin(HEADER)
  if (!bytes) return { answer }
  const view = new DataView(bytes.buffer)
  if (view.getUint32(0, true) !== 0x31535846 || view.getUint32(4, true) !== 6) return {}
  const store = await Store.open(url, remote.version, options)
  const core = await coreOf()
  const open = async () => {
    const pager = new Pager(core, remote, store, options)
    try {
      return { core, pager, ...(await pager.open(bytes, total, options)) }
    } catch (error) {
      pager.close()
      throw error
    }
  }
  const opened = await open().catch(async (error) => {
    if (!store?.size || signal?.aborted) throw error
    await store.clear()         // which may be what is damaged
    return open()
  })
  remote.opened()
  return opened
}
