// node paging_speed.mjs PACKAGE FILE RATE FRAMES MEMORY BUDGET: times drawing a scene while it is streamed at RATE
// bytes per second. BUDGET is the number of Gaussians in a picture.
import { fork } from 'node:child_process'
import { resolve } from 'node:path'
import { pathToFileURL } from 'node:url'
import { serveRanges } from './ranges.mjs'

const [folder, file, rate, frames, memory, budget] = process.argv.slice(2)
if (process.send) {
  const server = await serveRanges(file, { rate: Number(rate) })
  process.send(server.url)
  process.on('message', (word) => {
    if (word === 'end') process.exit()
    process.send({ sent: server.sent, requests: server.requests })
  })
} else {
  const child = fork(process.argv[1], process.argv.slice(2))
  const next = () => new Promise((done) => child.once('message', done))
  const url = await next()
  const told = () => {
    const answer = next()
    child.send('sent')
    return answer.then(JSON.stringify)
  }
  const { load } = await import(pathToFileURL(resolve(folder, 'fixsplat.js')))
  const options = { width: 640, height: 360, budget: Number(budget), targets: { colour: true } }
  const around = (angle) => [12 * Math.cos(angle), -2, 12 * Math.sin(angle)]
  const cameraAt = (i) => ({ eye: around(0.021 * i), look: around(0.021 * i + 0.5), near: 0.1 })
  const part = (list, p) => [...list].sort((a, b) => a - b)[Math.min(list.length - 1, Math.floor(p * list.length))]
  const shown = (list) => [0.5, 0.99, 1].map((p) => part(list, p).toFixed(1)).join(', ')
  const took = (draw) => {
    const start = performance.now()
    draw()
    return performance.now() - start
  }

  const start = performance.now()
  const scene = await load(url, { threads: 1, paging: { memory: Number(memory) } })
  let frame = scene.render(cameraAt(0), options)
  console.log(`first picture: ${Math.round(performance.now() - start)} ms, ${await told()} of ${scene.bytes} bytes`)
  const times = []
  let complete = 0
  for (let i = 0; i < Number(frames); i++) {
    times.push(took(() => (frame = scene.render(cameraAt(i), options))))
    scene.foresee(cameraAt(i + 15), options)
    complete += frame.missing === 0
    await new Promise((done) => setTimeout(done, Math.max(0, 33 - times.at(-1))))
  }
  console.log(`ms a picture, half, 99 %, all of them in at most: ${shown(times)}; ${complete} complete; ${await told()}`)
  const again = []
  for (let i = 0; i < Number(frames); i += 10) {
    await scene.complete(cameraAt(i), options)
    again.push(took(() => scene.render(cameraAt(i), options)))
  }
  console.log(`the same with nothing missing: ${shown(again)}`)
  const megabytes = (bytes) => `${Math.round(bytes / 1e6)} MB`
  const { buffer } = scene.inside[0].c.memory
  console.log(`module ${megabytes(buffer.byteLength)}, process ${megabytes(process.memoryUsage().rss)}`)
  child.send('end')
  process.exit()
}
