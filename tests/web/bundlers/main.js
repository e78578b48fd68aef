// A web program that uses the npm package. bundlers.mjs builds it with several bundlers. Its results are stored in
// `globalThis.result`.
import { load, Screen, setAssets } from '@LOAD@'
import '@VIEWER@'

const SIZE = { width: 64, height: 48 }
const camera = { eye: [2, -1, -4] }
const pause = (milliseconds) => new Promise((done) => setTimeout(done, milliseconds))

async function draw(scene, threads) {
  for (let i = 0; i < 500 && scene.threads < threads; i++) await pause(10)
  return { threads: scene.threads, hash: hashOf(scene.render(camera, SIZE)) }
}

function hashOf(bytes) {
  let h = 0xcbf29ce484222325n
  for (const byte of bytes) h = BigInt.asUintN(64, (h ^ BigInt(byte)) * 0x100000001b3n)
  return h.toString(16).padStart(16, '0')
}

async function run() {
  const many = globalThis.crossOriginIsolated ? 2 : 1
  const threaded = await draw(await load('/scene.ply', { threads: 2 }), many)
  const scene = await load('/scene.ply', { threads: 1 })
  const single = await draw(scene, 1)
  const plain = await load('/scene.ply', { simd: false }).then((plain) => draw(plain, 1), ({ message }) => message)
  const screen = await Screen.open(document.createElement('canvas'), 'webgl2', { threads: 1 })
  screen.draw([{ scene }], camera, SIZE)
  return { threaded, single, plain, webgl: hashOf(await screen.pixels()) }
}

globalThis.setAssets = setAssets
if (location.hash === '#assets') setAssets('/published')
const viewer = document.createElement('fixsplat-viewer')
viewer.addEventListener('error', (event) => (globalThis.said = event.message))
const view = '0.3,-0.9,-4,0,0,0,0,-1,0,45'
for (const [name, value] of Object.entries({ noui: '', threads: 2, background: '#0e1116', view, src: '/scene.ply' }))
  viewer.setAttribute(name, value)
viewer.style.cssText = 'width: 320px; height: 200px'
document.body.append(viewer)
run().then((found) => (globalThis.result = found), (error) => (globalThis.result = { error: error.stack }))
