// node import.mjs PACKAGE WORD ARGUMENT...: what tests/scripts/web.sh asks of the readers and of `load`.
import assert from 'node:assert/strict'
import { File } from 'node:buffer'
import { once } from 'node:events'
import { existsSync, readFileSync, readdirSync } from 'node:fs'
import { createServer } from 'node:http'
import { basename, dirname, join, resolve } from 'node:path'
import { pathToFileURL } from 'node:url'

const [folder, word, ...args] = process.argv.slice(2)
const { load } = await import(pathToFileURL(resolve(folder, 'fixsplat.js')))

/** Fails with words, and not by a fault of JavaScript or the module. */
async function refused(source, words, options) {
  await assert.rejects(load(source, options), (error) => {
    assert.equal(error.constructor, Error, error.stack)
    assert.match(error.message, words)
    assert.doesNotMatch(error.message, /cannot be read: (memory|unreachable|null|table|index)/)
    return true
  })
}

/** A server whose answers `serve(request, answer)` writes, and its address. */
async function serverOf(serve) {
  const server = createServer(serve).listen(0, '127.0.0.1')
  await once(server, 'listening')
  return [server, `http://127.0.0.1:${server.address().port}`]
}

const pause = (milliseconds) => new Promise((done) => setTimeout(done, milliseconds))
const packedOf = async (source) => Buffer.from((await load(source)).packed)

const words = {
  // The first of a scene's files: the same bytes from a path, a server and a list of files.
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

  // Cut anywhere, or with any byte another: words, or a scene.
  async hurt(...paths) {
    for (const path of paths) {
      const bytes = new Uint8Array(readFileSync(path))
      const step = Math.ceil(bytes.length / 150)
      for (let end = 1; end < bytes.length; end += step) {
        if (path.endsWith('.splat') && end % 32 === 0) continue       // a scene of fewer
        if (path.endsWith('.spz') && end >= bytes.length - 12) continue   // without its extension
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

  // What tests/test_bombs.c wrote into a folder.
  async bombs(root) {
    const beyond = /Gaussians or more in \d+ bytes of files, beyond the limit/
    await refused(join(root, 'padded.sog'), beyond)
    await refused(join(root, 'large.sog'), beyond)
    await refused(join(root, 'json.sog'), /bytes of memory or more, beyond the limit/)
    await refused(join(root, 'inflating.spz'), beyond)
    await refused(join(root, 'instances.glb'), beyond)
  },

  // An .spz of version 4, where zstd is not built in.
  async without(path) {
    await refused(path, /built without zstd/)
  },

  // A scene of 20000 Gaussians, sent in parts.
  async preview(path) {
    const bytes = readFileSync(path)
    const parts = [0, 0.4, 0.41, 0.8, 1].map((share) => Math.floor(share * bytes.length))
    const [server, base] = await serverOf(async (request, answer) => {
      const length = request.url === '/huge' ? 4e9 : request.url === '/cut' ? bytes.length + 1 : bytes.length
      if (request.url !== '/unknown') answer.setHeader('content-length', length)
      for (let i = 1; i < parts.length; i++) {
        answer.write(bytes.subarray(parts[i - 1], parts[i]))
        await pause(i === 1 ? 900 : 20)
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

  // A scene that is there at once: of a large one every so many-th Gaussian before it is packed, of others nothing.
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

await words[word](...args)
