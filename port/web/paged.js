// Streams scenes with levels of detail, and moving scenes, by range requests. The tables of the file (palette, tree,
// motion, first headers) are loaded first. A chunk has the data of 256 Gaussians, and is loaded into a pool of memory
// when a picture needs it. A full pool evicts the least recently used chunk. Leaves are the chunks of the finest level,
// nodes the coarser chunks. Chunk numbers begin with the leaves. A chunk of a moving scene has a time in which it is
// alive (drawn).

import { fetched, later, Watch } from './read.js'
import { Store } from './store.js'

const HEADER = 192
const CHUNK_HEADER = 128
const GAUSSIANS = 256           // number of Gaussians in a chunk
const NOTHING = 2 ** 32 - 1
const POOL = 2 ** 28            // default size in bytes of the pool on a WebGPU device
const HEADS = -2                // number of the buffer of chunk headers, see gpu_pieces in webgpu.c
// number of coarsest chunks, or of the first chunks in time, which are loaded before the first picture and never evicted
const TOP = 64
const BLOCK = 2048              // number of chunk headers in one request
const PIECE = 1 << 20           // largest number of bytes of a table in one request
const MOTION_HEADER = 16        // number of 32-bit words in the header of a scene's motion, see packed.h
const LOOPS = 1                 // FXS_MOTION_LOOPS
const RUN = 1 << 19             // largest size of one request for chunks, in bytes
const GAP = 1 << 15             // largest gap in bytes between wanted chunks in one request
const AT_ONCE = 6               // default number of simultaneous requests
const MEMORY = 512e6            // default size of the pool of chunks in bytes
const LEAST_PLACES = 256        // smallest capacity of the pool in chunks
const BUDGET = 1e6              // default budget: largest number of Gaussians in a picture
const TRIES = 5                 // number of attempts for a request; only 2 if the server is slow
const PAUSE = 100               // milliseconds: the pause before attempt i + 1 of a request is PAUSE * 2^i
const AGAIN = 5000              // milliseconds after a temporary failure before pictures request chunks again
const TELL = 50                 // minimum milliseconds between two calls of the callback `changed`

const pause = (milliseconds) => new Promise((done) => setTimeout(done, milliseconds))

const lasting = (words) => Object.assign(new Error(words), { isLasting: true })

// ---- Requests to the server -----------------------------------------------------------------------------------

class Remote {
  #url
  #options
  #tag
  #modified
  #running = new Set()
  #ended = false

  constructor(url, name, { silence, signal }) {
    Object.assign(this, { name })
    this.#url = url
    this.#options = { silence, signal }
  }

  opened() {
    this.#options.signal = undefined
  }

  get version() {
    return this.#tag ?? this.#modified ?? ''
  }

  /** Requests the first bytes of the file. Returns { bytes, total } with these bytes and the size of the file. If the
      server does not support range requests, returns { answer } with the whole file, or {}. */
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
    // The request header if-range needs a strong ETag; for another origin, it also needs CORS permission.
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

// ---- The scene in memory --------------------------------------------------------------------------------------

/** Loads the chunks (256 Gaussians each) of a streamed scene into the pool. Each place of the pool can hold one
    chunk. */
export class Pager {
  #core
  #at
  #remote
  #store
  #text
  #layout
  #places
  #used = 0
  #spare = []
  #victims = []                 // places of the pool whose chunks may be evicted; the least recently used place is last
  #fullAt = -1                  // number of the last frame that computed #victims, the places to evict
  #chunkOf
  #now = new Uint32Array(0)     // missing chunks of the last picture, the most important first
  #wanted = this.#now
  #cursor = 0                   // index in #wanted, the list of missing chunks, of the next chunk to request
  #marks
  #mark = 0
  #turn = 0
  #busy = new Set()
  #blocks                       // state of each block of BLOCK chunk headers: 0 missing, 1 requested, 2 loaded
  #pendingBlocks = 0
  #headersRunning = 0
  #running = 0
  #most
  #waiting = []
  #changed
  #told = 0
  #timer
  #ended = false
  #times                        // of a moving scene: 4 words a chunk, which begin with the times from and to, in Q16
  #inTime                       // the chunks of a moving scene, ordered by the time from
  failure = null

  constructor(core, remote, store, { changed, requests = AT_ONCE }) {
    this.#core = core
    this.#remote = remote
    this.#store = store
    this.#changed = changed
    this.#most = requests
    this.#text = core.copyText(remote.name)
  }

  async open(header, total, { memory = MEMORY, progress }) {
    this.#allocate(header, total, memory)
    const facts = await (this.#layout.hasTree ? this.#openTree(progress) : this.#openMoving(progress))
    this.#core.check(this.#core.c.paged_coarse(this.#at, this.#used))
    return { at: this.#at, facts }
  }

  async #openTree(progress) {
    const core = this.#core
    const { leaves, chunkBytes, palette, tree, nodeHeaders, nodeRows } = this.#layout
    const top = Math.min(TOP, leaves - 1)
    const block = Math.min(BLOCK, leaves - 1)
    await this.#readAll([
      ...this.#piecesOf(palette),
      { ...nodeHeaders, bytes: block * CHUNK_HEADER },
      { at: this.#layout.pool, from: nodeRows, bytes: top * chunkBytes },
      ...this.#piecesOf(tree),
    ], progress)
    const facts = this.#spread(block)
    this.#orderInTime()
    for (let i = 0; i < top; i++) this.#take(leaves + i, i)
    this.#used = top
    this.#check('paged_headers', leaves, leaves + block)
    this.#check('paged_rows', leaves, leaves + top)
    this.#blocks[0] = 2
    this.#pendingBlocks--
    return facts
  }

  /** Loads the tables of a moving scene without a tree, and then the first chunks in time. */
  async #openMoving(progress) {
    await this.#readAll(this.#piecesOf(this.#layout.palette), progress)
    const facts = this.#spread(0)
    this.#orderInTime()
    const first = this.#firstInTime()
    await this.#inParallel([...new Set(first.map((chunk) => this.#blockOf(chunk)))], (block) => this.#jobOfBlock(block)())
    this.#mark++
    for (const chunk of first) this.#marks[chunk] = this.#mark
    await this.#inParallel(first, async (chunk) => {
      if (!this.#isThere(chunk) && !this.#busy.has(chunk)) await this.#jobOfRows(chunk)()
    })
    return facts
  }

  #spread(block) {
    this.#core.check(this.#core.c.paged_spread(this.#at, this.#text, block))
    return this.#core.get(0, 13)
  }

  #piecesOf({ at, from, bytes }) {
    const pieceAt = (i) => ({ at: at + i, from: from + i, bytes: Math.min(PIECE, bytes - i) })
    return Array.from({ length: Math.ceil(bytes / PIECE) }, (_, i) => pieceAt(PIECE * i))
  }

  async #inParallel(list, run) {
    const left = [...list]
    await Promise.all(Array.from({ length: this.#most }, async () => {
      while (left.length) await run(left.shift())
    }))
  }

  async #readAll(parts, progress) {
    const all = parts.reduce((sum, { bytes }) => sum + bytes, 0)
    let there = 0
    await this.#inParallel(parts, async ({ at, from, bytes }) => {
      let own = 0
      const came = (now) => {
        there += now - own
        own = now
        progress?.({ stage: 'download', done: there / all, bytes: there })
      }
      if (bytes) this.#put(at, await this.#read(from, from + bytes, came))
      came(bytes)
    })
  }

  // ---- Moving scenes ------------------------------------------------------------------------------------------

  #orderInTime() {
    const { chunks, motion } = this.#layout
    if (!motion) return
    const [, duration, , flags] = this.#words(motion, MOTION_HEADER)
    this.#times = new Int32Array(this.#core.c.memory.buffer, motion + 4 * MOTION_HEADER, 4 * chunks).slice()
    this.#inTime = Uint32Array.from({ length: chunks }, (_, chunk) => chunk)
    this.#inTime.sort((a, b) => this.#times[4 * a] - this.#times[4 * b])
    Object.assign(this.#layout, { duration, loops: (flags & LOOPS) !== 0 })
  }

  /** Returns at most TOP of the chunks that are alive at the start, or if these are fewer, the first chunks in time. */
  #firstInTime() {
    const list = this.#inTime
    const top = Math.min(TOP, list.length)
    const count = Math.max(this.#aliveWithin(0, 1).length, top)
    return Array.from({ length: top }, (_, i) => list[Math.floor((count * i) / top)])
  }

  /** Returns the chunks that are alive from the time `from` until before `to` (Q16), ordered by their first times. */
  #aliveWithin(from, to) {
    const found = []
    for (const chunk of this.#inTime) {
      if (this.#times[4 * chunk] >= to) break
      if (this.#times[4 * chunk + 1] > from) found.push(chunk)
    }
    return found
  }

  #aliveBetween(from, to) {
    const { duration, loops } = this.#layout
    const span = Math.max(Math.round(65536 * (to - from)), 0) + 1
    const first = Math.floor(65536 * from)
    if (!loops) return this.#aliveWithin(Math.min(Math.max(first, 0), duration), Math.max(first + span, 1))
    const begin = ((first % duration) + duration) % duration
    const list = this.#aliveWithin(begin, begin + span)
    return begin + span > duration ? [...new Set([...list, ...this.#aliveWithin(0, begin + span - duration)])] : list
  }

  /** Requests chunks that are alive between two times in seconds, the earliest first, after the chunks that the last
      picture lacked. With a tree, these are the nodes, the coarsest first: pictures request the leaves that they need.
      At most half of the pool is for them. Returns the number of missing chunks. */
  prefetch(from, to) {
    if (!this.#times) return 0
    const { leaves, hasTree } = this.#layout
    const alive = this.#aliveBetween(from, to)
    const coarse = () => alive.filter((chunk) => chunk >= leaves).sort((a, b) => a - b)
    const list = (hasTree ? coarse() : alive).slice(0, this.#places >> 1)
    const { where, chunks, stamps } = this.#layout
    const [places, used] = [this.#words(where, chunks), this.#words(stamps, this.#places)]
    const missing = list.filter((chunk) => places[chunk] === NOTHING)
    for (const chunk of list) if (places[chunk] !== NOTHING) used[places[chunk]] = this.#turn
    this.#want(missing, true)
    return missing.length
  }

  // ---- Pools --------------------------------------------------------------------------------------------------

  #allocate(header, total, memory) {
    const core = this.#core
    const at = core.copy(header)
    try {
      const hasParts = core.check(core.c.paged_header(this.#text, at))
      const [bytes, chunkBytes, chunks] = core.get(0, 3)
      if (!hasParts || total < bytes)
        throw lasting(`${this.#remote.name}: damaged or cut short: ${total} bytes, expected ${bytes}`)
      this.bytes = bytes
      const least = Math.min(chunks, LEAST_PLACES)
      let places = Math.max(Math.min(chunks, Math.floor(memory / chunkBytes)), least)
      while (!(this.#at = core.c.paged_open(at, places) >>> 0) && places > least) places = Math.max(places >> 1, least)
      if (!this.#at) throw lasting(`${this.#remote.name}: too little memory for the tables of ${chunks} parts`)
      this.#layOut(core.get(0, 20), places, chunkBytes, chunks)
    } finally {
      core.c.release(at)
    }
  }

  #layOut(numbers, places, chunkBytes, chunks) {
    const part = (i) => ({ at: numbers[i], from: numbers[i + 1], bytes: numbers[i + 2] })
    const [leafRows, nodeRows, pool, where, stamps, wanted, motion] = numbers.slice(13)
    const [palette, tree, nodeHeaders, leafHeaders] = [1, 4, 7, 10].map(part)
    const leaves = numbers[0]
    this.#layout = { leaves, chunks, chunkBytes, palette, tree, nodeHeaders, leafHeaders, leafRows, nodeRows, pool }
    Object.assign(this.#layout, { where, stamps, wanted, motion, hasTree: chunks > leaves })
    this.#places = places
    this.#chunkOf = new Uint32Array(places)
    this.#marks = new Uint32Array(chunks)
    this.nodeBlocks = Math.ceil((chunks - leaves) / BLOCK)
    this.#blocks = new Uint8Array(this.nodeBlocks + Math.ceil(leaves / BLOCK))
    this.#pendingBlocks = this.#blocks.length
  }

  get budget() {
    const { chunks, hasTree } = this.#layout
    return !hasTree || chunks <= Math.min(this.#places, BUDGET / GAUSSIANS) ? 0 : Math.min(BUDGET, this.most)
  }

  /** Returns the largest budget (number of Gaussians in a picture). The budget is half the pool, since coarse chunks
      stay in the pool while finer chunks are loaded. */
  get most() {
    if (!this.#layout.hasTree || this.#places >= this.#layout.chunks) return Infinity
    return ((this.#places - TOP) >> 1) * GAUSSIANS
  }

  /** Returns the number of blocks of chunk headers that pictures may lack. Pictures of a scene without a tree lack none,
      since a chunk without a header counts as missing. */
  get pending() {
    return this.#layout.hasTree ? this.#pendingBlocks : 0
  }

  looked(ahead) {
    const count = this.#core.c.paged_wanted(this.#at)
    this.#turn = this.#core.c.paged_turn(this.#at)
    this.lacking = count
    this.#want(this.#words(this.#layout.wanted, count), ahead)
  }

  /** Requests missing chunks. With `ahead`, they come after those that the last picture lacked. */
  #want(list, ahead) {
    if (!ahead) {
      this.#now = list.slice()
      this.#mark++
    }
    this.#wanted = new Uint32Array(this.#now.length + (ahead ? list.length : 0))
    this.#wanted.set(this.#now)
    if (ahead) this.#wanted.set(list, this.#now.length)
    for (const chunk of list) this.#marks[chunk] = this.#mark
    this.#cursor = 0
    const isOver = this.failure && !this.failure.isLasting && performance.now() - this.failedAt > AGAIN
    if (isOver) this.failure = null
    this.#fetch()
  }

  /** Makes a pool of at most `most` bytes on a WebGPU device, with the coarsest chunks. A frame draws from the pool
      after `use`, and `upload` then sends chunks that the frame lacked, for later frames. `scoped` runs a function and
      returns a promise that is rejected if the device reports an error; the pool has this promise as `made`. */
  poolOn(device, rooms, scoped, most = POOL) {
    const { c } = this.#core
    const pool = { at: this.#core.place(c.gpu_pool(this.#at, most)), rows: [] }
    pool.use = () => (c.gpu_use(this.#at, pool.at), pool)
    pool.upload = () => this.#upload(pool, rooms, device)
    pool.free = () => (pool.at = c.release(pool.at))
    pool.check = () => {
      if (!pool.at) throw new Error(`${this.#remote.name}: was freed, or the device failed: draw again`)
    }
    pool.use()
    pool.made = scoped(() => {
      const made = (part) => this.#bufferOf(device, rooms, part)
      pool.heads = made(HEADS)
      pool.rows = Array.from({ length: c.gpu_parts(rooms, this.#at) }, (_, part) => made(part))
      pool.upload()
    })
    pool.made.catch(() => {})
    return pool
  }

  /** Makes a GPU buffer of a pool, which has the palette but no chunks. */
  #bufferOf(device, rooms, part) {
    const core = this.#core
    core.c.gpu_pieces(rooms, this.#at, part)
    const [size, , , , , , , palette, bytes] = core.get(0, 9)
    const usage = GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_DST
    const buffer = device.createBuffer({ size: Math.max(size, 64), usage })
    if (bytes) device.queue.writeBuffer(buffer, 0, core.bytes(palette, bytes).slice())
    return buffer
  }

  #upload({ at, heads, rows }, rooms, { queue }) {
    const core = this.#core
    const count = at && !this.#ended ? core.c.gpu_step(at) : 0
    const write = (buffer, to, from, bytes) => queue.writeBuffer(buffer, to, core.bytes(from, bytes).slice())
    for (const place of count ? this.#words(core.get(0, 1)[0], count) : []) {
      core.c.gpu_place(rooms, at, place)
      const [header, row, part, to] = core.get(0, 4)
      write(heads, CHUNK_HEADER * place, header, CHUNK_HEADER)
      write(rows[part], to, row, this.#layout.chunkBytes)
    }
    if (count) this.#came()
  }

  arrival() {
    if (this.failure) return Promise.reject(this.failure)
    if (!this.#running) {
      const words = `${this.#remote.name}: the pool has no room for this picture: a larger paging.memory has`
      return Promise.reject(new Error(words))
    }
    return new Promise((resolve, reject) => this.#waiting.push({ resolve, reject }))
  }

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

  #next() {
    if (this.pending && !this.#headersRunning) {
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

  /** Reads a range of the file and passes its bytes to `take`. If `take` throws, because the bytes are damaged, the
      range is read once more from the server. */
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

  /** Stores the arrived chunks `first` to `end` - 1 in the pool. A chunk that no picture wants takes only a free place
      of the pool. */
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

  /** Returns a place of the pool for a chunk: a free place, else the place of the least recently used chunk. Returns -1
      if there is none. */
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

  /** Returns places of the pool that may be evicted, at most an eighth of the pool. Places that the last two frames
      used are left out. The least recently used place is last. */
  #oldest(stamps) {
    const keys = new Float64Array(this.#places)
    let count = 0
    for (let place = TOP; place < this.#places; place++)
      if (stamps[place] < this.#turn - 1) keys[count++] = stamps[place] * 2 ** 21 + place
    const sorted = keys.subarray(0, count).sort().subarray(0, Math.max(this.#places >> 3, 1))
    return Array.from(sorted, (key) => key % 2 ** 21).reverse()
  }

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

// Opens a file for streaming and returns its module, loader, address and facts as { core, pager, at, facts }. If the
// server sends the whole file, returns { answer }. If the file cannot be streamed, returns {}.
export async function openPaged(url, name, coreOf, { paging, progress, silence, signal }) {
  const options = { silence, ...paging, progress, signal }
  const remote = new Remote(url, name, options)
  const { bytes, total, answer } = await remote.begin(HEADER)
  if (!bytes) return { answer }
  const view = new DataView(bytes.buffer)
  if (view.getUint32(0, true) !== 0x31535846 || ![6, 7, 8].includes(view.getUint32(4, true))) return {}
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
    await store.clear()
    return open()
  })
  remote.opened()
  return opened
}
