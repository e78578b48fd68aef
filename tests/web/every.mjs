// node every.mjs PACKAGE SCENES MODULES PICTURES COMMAND: draws every scene of SCENES/real in the viewer, and compares
// the pictures with the output of the command-line program COMMAND. Checks that opening 100 scenes does not leak
// memory.
import assert from 'node:assert/strict'
import { readFileSync, readdirSync } from 'node:fs'
import { base, go, hash, inside, moved, native, open, page, pause, processes } from './chromium.mjs'
import { run, scenes, viewOf } from './chromium.mjs'

const SIZE = [1280, 720]
const LOADS = 50
const FIRST = 50
const MORE = 1.05 // largest allowed ratio of memory at the end to memory after opening FIRST scenes

const isScene = (name) => /\.(ply|splat|spz|sog|glb)$/.test(name)
const files = readdirSync(`${scenes}/real`, { recursive: true }).filter(isScene)
const tests = {}

const time = () =>
  inside(`return await new Promise((done) => {
    v.addEventListener('frame', ({ detail }) => done(Math.round(detail.milliseconds)), { once: true });
    v.setAttribute('background', '#0e1116') })`)

const helpers = () => page.workers().filter((worker) => worker.url().endsWith('/thread.js')).length

for (const file of files)
  tests[file] = async () => {
    const times = []
    for (const threads of [1, 2]) {
      await open(`?scene=/scenes/real/${file}&backend=wasm&threads=${threads}`, ...SIZE)
      assert.equal(helpers(), threads - 1)
      const exact = native(`real/${file}`, await viewOf(), SIZE.join('x'))
      for (const backend of ['wasm', 'webgl2']) {
        await inside(`v.setAttribute('backend', args[0])`, backend)
        await moved()
        assert.equal(await inside('return v.backend'), backend)
        assert.equal(await hash(), exact, `${backend}, ${threads} threads`)
        times.push(`${backend} ${threads}: ${await time()} ms`)
        await inside(`v.removeAttribute('background')`)
        await moved()
      }
    }
    console.log(`  ${file}: ${times.join(', ')}`)
  }

async function memory() {
  await pause(5000)
  const { bytes } = await page.evaluate(() => performance.measureUserAgentSpecificMemory())
  const resident = (id) => 4096 * Number(readFileSync(`/proc/${id}/statm`, 'utf8').split(' ')[1])
  return { bytes, resident: Math.max(...(await processes('renderer')).map(resident)) }
}

tests['memory after 50 scenes'] = async () => {
  await go('')
  await page.setContent(`<base href="${base}/"><script type="module" src="viewer/viewer.js"></script>`)
  const openMany = (count) =>
    page.evaluate(
      async (src, count) => {
        for (let i = 0; i < count; i++) {
          const own = document.createElement('fixsplat-viewer')
          Object.assign(own.style, { width: '640px', height: '360px' })
          own.setAttribute('backend', i % 10 ? 'wasm' : 'webgl2')
          own.setAttribute('src', src)
          own.setAttribute('keep', 0)
          document.body.append(own)
          while (own.state !== 'still') await new Promise((done) => setTimeout(done, 20))
          own.remove()
        }
      },
      'scenes/real/guitar/guitar.compressed.ply',
      count
    )
  await openMany(FIRST)
  const marks = [await memory()]
  await openMany(LOADS)
  marks.push(await memory())
  const megabytes = ({ bytes, resident }) => `${(bytes / 1e6).toFixed(2)} MB (${Math.round(resident / 1e6)} resident)`
  console.log(`  after ${FIRST} scenes ${megabytes(marks[0])}, after ${LOADS} more ${megabytes(marks[1])}`)
  assert.ok(marks[1].bytes <= MORE * marks[0].bytes)
}

await run(tests)
