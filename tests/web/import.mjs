// node import.mjs PACKAGE WORD ARGUMENT...: checks the scene file readers of the npm package, for tests/scripts/web.sh.
// WORD chooses a test.
import assert from 'node:assert/strict'
import { File } from 'node:buffer'
import { once } from 'node:events'
import * as fs from 'node:fs'
import { createServer } from 'node:http'
import { basename, dirname, join, resolve } from 'node:path'
import { pathToFileURL } from 'node:url'
import { run } from './words.mjs'

const { existsSync, readFileSync, readdirSync, writeFileSync } = fs
const [folder, word, ...args] = process.argv.slice(2)
const part = (name) => import(pathToFileURL(resolve(folder, name)))
const { load } = await part('fixsplat.js')

async function refused(source, words, options) {
  await assert.rejects(load(source, options), (error) => {
    assert.equal(error.constructor, Error, error.stack)
    assert.match(error.message, words)
    assert.doesNotMatch(error.message, /cannot be read: (memory|unreachable|null|table|index)/)
    return true
  })
}

async function serverOf(serve) {
  const server = createServer(serve).listen(0, '127.0.0.1')
  await once(server, 'listening')
  return [server, `http://127.0.0.1:${server.address().port}`]
}

async function sendOn(answer, drip = 0) {
  const bytes = Buffer.alloc(drip || 1 << 16)
  while (!answer.destroyed) {
    if (drip) await pause(10)
    if (!answer.write(bytes)) await new Promise((done) => answer.once('drain', done).once('close', done))
  }
}

async function timed(promise) {
  const start = performance.now()
  const error = await promise.then(() => null, (error) => error)
  return [performance.now() - start, error]
}

const pause = (milliseconds) => new Promise((done) => setTimeout(done, milliseconds))
const packedOf = async (source) => Buffer.from((await load(source)).packed)

const words = {
  async beside(path) {
    const [root, name] = [dirname(path), basename(path)]
    const want = await packedOf(path)
    const [server, base] = await serverOf((request, answer) => {
      const file = join(root, decodeURIComponent(request.url))
      answer.statusCode = existsSync(file) ? 200 : 404
      answer.end(existsSync(file) ? readFileSync(file) : '')
    })
    assert.deepEqual(await packedOf(`${base}/${name}`), want)
    server.close()
    const names = readdirSync(root, { recursive: true, withFileTypes: true }).filter((entry) => entry.isFile())
    const files = names.map((entry) => {
      const inside = join(entry.parentPath ?? entry.path, entry.name).slice(root.length + 1)
      return new File([readFileSync(join(root, inside))], inside)
    })
    assert.deepEqual(await packedOf(files.reverse()), want)
    if (files.length > 1)
      await refused(files.filter((file) => file.name === name), /cannot be opened|needs the file|no .* beside/)
  },

  async hurt(...paths) {
    for (const path of paths) {
      const bytes = new Uint8Array(readFileSync(path))
      const step = Math.ceil(bytes.length / 150)
      for (let end = 1; end < bytes.length; end += step) {
        if (path.endsWith('.splat') && end % 32 === 0) continue
        // An .spz file that is cut short is still valid if it lacks only the extension data at its end.
        if (path.endsWith('.spz') && end >= bytes.length - 12) continue
        await refused(bytes.slice(0, end), /./)
      }
      for (let at = 0; at < bytes.length; at += step) {
        const other = Uint8Array.from(bytes, (byte, i) => (i === at ? byte ^ 0x55 : byte))
        await load(other).then((scene) => scene.free(), (error) => {
          assert.equal(error.constructor, Error, error.stack)
          assert.doesNotMatch(error.message, /cannot be read: (memory|unreachable|null|table|index)/)
        })
      }
      ;(await load(bytes)).free()
    }
  },

  async bombs(root) {
    const beyond = /Gaussians or more in \d+ bytes of files, beyond the limit/
    await refused(join(root, 'padded.sog'), beyond)
    await refused(join(root, 'large.sog'), beyond)
    await refused(join(root, 'json.sog'), /bytes of memory or more, beyond the limit/)
    await refused(join(root, 'inflating.spz'), beyond)
    await refused(join(root, 'instances.glb'), beyond)
  },

  async names(root) {
    const asked = []
    const serve = (request, answer) => {
      asked.push(request.url)
      const file = join(root, decodeURIComponent(request.url))
      const isThere = request.url.startsWith('/foreign/') && existsSync(file)
      answer.writeHead(isThere ? 200 : 404)
      answer.end(isThere ? readFileSync(file) : '')
    }
    const [server, base] = await serverOf(serve)
    const [other, elsewhere] = await serverOf(serve)
    const names = ['../secret', '/secret', `${elsewhere.slice(5)}/x`, `${elsewhere}/x`, '//host:1/x', '%2e%2e/secret',
      '..%2fsecret', '%5c%5chost%5csecret', 'file:///etc/x', 'data:,x', 'blob:x', 'C:/x', 'below/../../secret',
      'below/..']
    fs.cpSync(join(root, 'plain'), join(root, 'foreign'), { recursive: true })
    const indexes = readdirSync(join(root, 'foreign'), { recursive: true }).filter((name) => /meta\.json$/.test(name))
    assert.ok(indexes.length > 1)
    for (const name of indexes) {
      const index = JSON.parse(readFileSync(join(root, 'plain', name)))
      index.more = ['json', 'webp'].flatMap((kind) => names.map((name) => `${name}.${kind}`))
      writeFileSync(join(root, 'foreign', name), JSON.stringify(index))
    }
    const want = await packedOf(join(root, 'plain', 'lod-meta.json'))
    assert.deepEqual(await packedOf(`${base}/foreign/lod-meta.json`), want)
    assert.ok(asked.length > 4)
    for (const url of asked) assert.match(url, /^\/foreign\/(?!.*(\/\.\.\/|%2e|%2f|%5c|secret|:))/i)
    const assets = await part('fixsplat_assets.js')
    const { readFile, readWithin, ...system } = await assets.ofSystem()
    const read = []
    assets.setSystem({ ...system,
      readFile: (url) => (read.push(url.href), readFile(url)),
      readWithin: (first, url) => (read.push(url.href), readWithin(first, url)) })
    assert.deepEqual(await packedOf(join(root, 'foreign', 'lod-meta.json')), want)
    const within = pathToFileURL(join(root, 'foreign')).href
    for (const url of read.filter((url) => !url.endsWith('.wasm'))) assert.ok(url.startsWith(`${within}/`), url)
    const [image] = readdirSync(join(root, 'foreign'), { recursive: true }).filter((name) => /\.webp$/.test(name))
    fs.mkdirSync(join(root, 'out'))
    fs.renameSync(join(root, 'foreign', image), join(root, 'out', 'image'))
    fs.symlinkSync(join(root, 'out', 'image'), join(root, 'foreign', image))
    await refused(join(root, 'foreign', 'lod-meta.json'), /webp: cannot be opened/)
    server.close()
    other.close()
  },

  async slow(sog) {
    const bytes = readFileSync(sog)
    const tree = { lods: { 0: { file: 0, offset: 0, count: 9 } } }
    const index = JSON.stringify({ lodLevels: 1, filenames: ['slow/meta.json'], tree })
    let [opened, closed] = [0, 0]
    const [server, base] = await serverOf(async (request, answer) => {
      opened++
      answer.on('close', () => closed++)
      if (request.url === '/silent.ply') return
      if (request.url.startsWith('/slow')) return sendOn(answer, 2)
      if (request.url === '/lod-meta.json') return answer.end(index)
      answer.setHeader('content-length', bytes.length)
      for (let at = 0; at < bytes.length; at += 2000) {
        answer.write(bytes.subarray(at, at + 2000))
        await pause(5)
      }
      answer.end()
    })
    const told = []
    const options = { silence: 500, progress: (progress) => told.push(progress) }
    await refused(`${base}/slow.ply`, /^slow\.ply: the server sent \d+ bytes in 0\.5 seconds$/, options)
    assert.ok(told.length && told.every(({ stage, bytes }) => stage === 'download' && bytes > 0))
    await refused(`${base}/slow.fxs`, /^slow\.fxs: the server sent \d+ bytes in 0\.5 seconds$/, options)
    await refused(`${base}/silent.ply`, /^silent\.ply: the server was silent for 0\.5 seconds$/, options)
    told.length = 0
    await refused(`${base}/lod-meta.json`, /^meta\.json: the server sent \d+ bytes in 0\.5 seconds$/, options)
    assert.ok(told.length > 1)
    const [took, error] = await timed(load(`${base}/steady.sog`, { silence: 500 }))
    assert.ok(took > 500 && !error, `${took} ms: ${error}`)
    await pause(50)
    assert.ok(opened > 5 && closed === opened, `${closed} of ${opened}`)
    for (const name of ['slow.ply', 'slow.fxs', 'silent.ply', 'lod-meta.json']) {
      const end = new AbortController()
      setTimeout(() => end.abort(new Error('enough')), 100)
      const [took, error] = await timed(load(`${base}/${name}`, { signal: end.signal }))
      assert.ok(error?.message === 'enough' && took < 1000, `${name}: ${error?.stack}, ${took} ms`)
    }
    await refused(sog, /^before$/, { signal: AbortSignal.abort(new Error('before')) })
    server.close()
    server.closeAllConnections()
  },

  // Checks that server answers that never end, or that claim 2 GB, are refused at once. The arguments are a .ply and an
  // .fxs file.
  async endless(ply, fxs) {
    const beginnings = {
      nothing: '', 'text.sog': 'Not found. '.repeat(1000), 'GIF89a.splat': 'GIF89a', 'more.ply': readFileSync(ply),
      'more.fxs': readFileSync(fxs),
      'huge.ply': readFileSync(ply, 'latin1').replace('vertex 700', 'vertex 99999999').slice(0, 4000),
    }
    let sent = 0
    const [server, base] = await serverOf((request, answer) => {
      const [, kind, name] = request.url.split('/')
      if (kind === 'announced') answer.setHeader('content-length', 2e9)
      answer.write(beginnings[name])
      const { write } = answer
      answer.write = (bytes) => ((sent += bytes.length), write.call(answer, bytes))
      if (name !== 'nothing' || kind !== 'announced') sendOn(answer)
    })
    const words = {
      nothing: /not a scene file/, 'text.sog': /not a scene file/, 'GIF89a.splat': /not a scene file/,
      'more.ply': /[MG]B or more, though its header asks for 0\.\d MB$/,
      'more.fxs': /[MG]B or more, though its header asks for 0\.\d MB$/,
      'huge.ply': /24.8 GB, and no more than 2\.0 GB can be read/,
    }
    await load(ply)
    globalThis.gc()
    const before = process.memoryUsage()
    let most = 0
    const progress = () => (most = Math.max(most, process.memoryUsage().arrayBuffers - before.arrayBuffers))
    for (const kind of ['unknown', 'announced'])
      for (const [name, said] of Object.entries(words)) {
        sent = most = 0
        const isSilent = name === 'nothing' && kind === 'announced'
        const options = { progress, silence: isSilent ? 200 : undefined }
        await refused(`${base}/${kind}/${name}`, isSilent ? /silent/ : said, options)
        assert.ok(sent < 50e6, `${kind}/${name}: ${sent} bytes`)
        assert.ok(most < 100e6, `${kind}/${name}: ${most} bytes of memory`)
      }
    server.close()
    server.closeAllConnections()
  },

  async redirected(fxs) {
    const { fetch } = globalThis
    globalThis.fetch = async (url, { headers } = {}) => {
      const bytes = readFileSync(fxs)
      const range = headers?.range && { 'content-range': `bytes 0-191/${bytes.length}` }
      const answer = new Response(range ? bytes.subarray(0, 192) : bytes, { status: range ? 206 : 200, headers: range })
      return Object.defineProperty(answer, 'url', { value: `${url}`.replace('https://good', 'http://bad') })
    }
    try {
      for (const name of ['scene.fxs', 'scene.ply', 'scene'])
        await refused(`https://good/${name}`, /leads from https to http:\/\/bad\//)
      assert.ok((await load('https://other/scene')).count > 0)
    } finally {
      globalThis.fetch = fetch
    }
  },

  async without(path) {
    await refused(path, /built without zstd/)
  },

  async preview(path) {
    const bytes = readFileSync(path)
    const parts = [0, 0.4, 0.41, 0.8, 1].map((share) => Math.floor(share * bytes.length))
    const [server, base] = await serverOf(async (request, answer) => {
      const length = request.url === '/huge' ? 4e9 : request.url === '/cut' ? bytes.length + 1 : bytes.length
      if (request.url !== '/unknown') answer.setHeader('content-length', length)
      const [before, isSeen] = [seen.length, ['/whole', '/cut'].includes(request.url)]
      for (let i = 1; i < parts.length; i++) {
        answer.write(bytes.subarray(parts[i - 1], parts[i]))
        await pause(i === 1 ? 900 : 20)
        for (let k = 0; i === 1 && isSeen && k < 100 && seen.length === before; k++) await pause(100)
      }
      if (length === bytes.length) answer.end()
      else answer.destroy()
    })
    const seen = []
    const told = []
    const options = {
      preview: async (scene) => {
        seen.push(scene.count)
        assert.equal(scene.render({}, { width: 64, height: 48 }).length, 4 * 64 * 48)
        await pause(1)
        scene.free()
      },
      progress: (progress) => told.push(progress),
    }
    const scene = await load(`${base}/whole`, options)
    assert.deepEqual(Buffer.from(scene.packed), await packedOf(bytes))
    assert.ok(seen.length === 1 && seen[0] > 1000 && seen[0] <= 10000, `previews: ${seen}`)
    const downloads = told.filter(({ stage }) => stage === 'download')
    assert.deepEqual(downloads.at(-1), { stage: 'download', done: 1, bytes: bytes.length })
    assert.equal(told.at(-1).stage, 'prepare')
    await refused(`${base}/cut`, /broke off after/, options)
    assert.equal(seen.length, 2)
    await refused(`${base}/huge`, /4\.0 GB/, options)
    assert.equal((await load(`${base}/unknown`, options)).count, scene.count)
    server.close()
  },

  async sampled() {
    const records = new Float32Array(8 * 640000).map((_, i) => (i & 7) < 3 ? (i % 999) / 99 : (i & 7) < 6 ? 0.1 : 1)
    const seen = []
    for (const count of [590000, 640000]) {
      const options = { preview: (scene) => seen.push(scene.count) }
      const scene = await load(new Uint8Array(records.buffer, 0, 32 * count), options)
      assert.equal(scene.count, count)
      scene.free()
    }
    assert.ok(seen.length === 1 && seen[0] > 50000 && seen[0] <= 100000, `previews: ${seen}`)
  },
}

await run(words, word, args)
