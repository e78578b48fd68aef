// A test server of one file. It answers requests for byte ranges, at a limited rate and with simulated faults.
import { createReadStream, openSync, readSync, statSync } from 'node:fs'
import { createServer } from 'node:http'

const pause = (ms) => new Promise((done) => setTimeout(done, ms))

/** Serves a file. faults({ first, end, count }, request) returns faults of an answer: { status, headers, bytes (a
   function that changes the right bytes), cut (number of bytes after which the connection breaks), drip (two bytes at a
   time), silent (no bytes), whole (the file instead of a range), delay (milliseconds) }. */
export async function serveRanges(path, { rate = Infinity, faults = () => ({}), more } = {}) {
  const file = openSync(path)
  const { size } = statSync(path)
  const modified = 'Mon, 01 Jan 2024 00:00:00 GMT'
  const told = { sent: 0, requests: 0, ranges: [], rate, faults, tag: '"one"', modified }
  let due = performance.now()

  async function send(answer, bytes) {
    for (let at = 0; at < bytes.length && !answer.destroyed; at += 65536) {
      const part = bytes.subarray(at, at + 65536)
      due = Math.max(due, performance.now()) + (1000 * part.length) / told.rate
      if (due - performance.now() > 2) await pause(due - performance.now())
      told.sent += part.length
      if (!answer.write(part)) await new Promise((done) => answer.once('drain', done).once('close', done))
    }
  }

  const server = createServer(async (request, answer) => {
    if (more && (await more(request, answer))) return
    told.requests++
    const [, from, to] = request.headers.range?.match(/^bytes=(\d+)-(\d+)$/) ?? []
    const same = !request.headers['if-range'] || request.headers['if-range'] === told.tag
    const [first, end] = from === undefined ? [0, size] : [Number(from), Math.min(Number(to) + 1, size)]
    const fault = told.faults({ first, end, count: told.requests }, request) ?? {}
    if (fault.delay) await pause(fault.delay)
    const isPart = from !== undefined && same && !fault.whole
    if (isPart) told.ranges.push([first, end])
    const headers = { 'accept-ranges': 'bytes', 'access-control-allow-origin': '*' }
    if (told.tag) headers.etag = told.tag
    if (told.modified) headers['last-modified'] = told.modified
    if (isPart) headers['content-range'] = `bytes ${first}-${end - 1}/${size}`
    headers['content-length'] = isPart ? end - first : size
    Object.assign(headers, fault.headers)
    for (const name of Object.keys(headers)) if (headers[name] === null) delete headers[name]
    answer.writeHead(fault.status ?? (isPart ? 206 : 200), headers)
    answer.flushHeaders()
    if (fault.silent) return
    for (let at = first; fault.drip && at < end && !answer.destroyed; at += 2) {
      answer.write(Buffer.alloc(2))
      await pause(10)
    }
    if (!isPart && !fault.bytes) {
      for await (const part of createReadStream(path)) {
        await send(answer, part)
        if (answer.destroyed) return
      }
      return answer.end()
    }
    let bytes = Buffer.alloc(end - first)
    readSync(file, bytes, 0, bytes.length, first)
    if (fault.bytes) bytes = fault.bytes(bytes, first)
    if (fault.cut !== undefined) {
      await send(answer, bytes.subarray(0, fault.cut))
      return answer.destroy()
    }
    await send(answer, bytes)
    answer.end()
  }).listen(0, '127.0.0.1')
  await new Promise((done) => server.once('listening', done))
  told.url = `http://127.0.0.1:${server.address().port}/scene.fxs`
  told.size = size
  told.close = () => {
    server.close()
    server.closeAllConnections()
  }
  return told
}
