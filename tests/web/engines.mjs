// Parts that three.mjs and playcanvas.mjs share: tests that draw a wall (a mesh) in front of splats, amid them and
// behind them.
import assert from 'node:assert/strict'
import { mkdirSync, writeFileSync } from 'node:fs'
import { base, frame, hashOf, work } from './screens.mjs'

export const [WIDTH, HEIGHT] = [160, 100]
export const EYE = ['--eye', '0,-1,-4', '--look', '0,0,0', '--near', '0.1']
export const seen = frame('knot', WIDTH, HEIGHT, EYE)

export const PAGE = `const { render, pick } = await import('fixsplat')
  const [width, height] = [${WIDTH}, ${HEIGHT}]
  function bytesOf(canvas) {
    const flat = new OffscreenCanvas(canvas.width, canvas.height).getContext('2d', { willReadFrequently: true })
    flat.drawImage(canvas, 0, 0)
    return flat.getImageData(0, 0, canvas.width, canvas.height).data
  }
  const pictures = {}
  async function keep(name, canvas) {
    const copy = new OffscreenCanvas(canvas.width, canvas.height)
    copy.getContext('2d').drawImage(canvas, 0, 0)
    const bytes = new Uint8Array(await (await copy.convertToBlob()).arrayBuffer())
    pictures[name] = btoa(String.fromCharCode(...bytes))
  }
  const apart = (a, b) => a.reduce((most, byte, i) => Math.max(most, Math.abs(byte - b[i])), 0)
  /** Draws splats and a wall before, amid and behind them, by a function that gives the picture's bytes for a distance
      of the wall, with splats or without: how far the bytes are from premultiplied splats over the wall; and the wall's
      pixels of which nothing, some or all is seen. */
  async function walled(splats, view, draw) {
    const back = view.orthographic ? 11 : 0, all = []
    for (const distance of [2, 4.03, 8]) {
      const red = await draw(distance, false), shows = await draw(distance, true)
      const occluder = new Uint32Array(width * height).fill(0xffffffff)
      occluder.forEach((_, i) => red[4 * i] && (occluder[i] = (distance + back) * 2 ** 20))
      const targets = { colour: 'premultiplied', occluder }
      const { colour } = render([splats.placed], view, { width, height, depthBits: 20, targets })
      const found = { most: 0, wall: 0, both: 0, splats: 0 }
      occluder.forEach((_, i) => {
        const coverage = colour[4 * i + 3]
        if (![0, 255].includes(red[4 * i])) return
        if (red[4 * i]) found[coverage === 0 ? 'wall' : coverage === 255 ? 'splats' : 'both']++
        for (const c of [0, 1, 2]) {
          const wanted = colour[4 * i + c] + red[4 * i + c] * (1 - coverage / 255)
          found.most = Math.max(found.most, Math.abs(Math.min(255, wanted) - shows[4 * i + c]))
        }
      })
      all.push(found)
    }
    return all
  }`

export function checkWalls(name, [before, amid, behind]) {
  assert.ok(Math.max(before.most, amid.most, behind.most) <= 1, `${name}: ${amid.most} and ${behind.most} apart`)
  assert.ok(before.wall > 1000 && !before.both && !before.splats, `${name}: ${JSON.stringify(before)}`)
  assert.ok(amid.splats > 100 && behind.splats > amid.splats + 50, `${name}: ${JSON.stringify([amid, behind])}`)
}

export function keepPictures(pictures) {
  const folder = process.env.PICTURES
  if (folder) mkdirSync(folder, { recursive: true })
  for (const [name, text] of folder ? Object.entries(pictures) : [])
    writeFileSync(`${folder}/${name}.png`, Buffer.from(text, 'base64'))
}

export function hashOfPlaced(placed) {
  const objects = placed.map(({ time, ...how }) => ({ file: 'knot.fxs', ...how }))
  writeFileSync(`${work}/placed.json`, JSON.stringify({ objects }))
  const args = ['--eye', '0,1,4', '--look', '0,0,0', '--up', '0,1,0', '--near', '0.1', '--size', `${WIDTH}x${HEIGHT}`]
  return hashOf({ args: ['--scene', `${work}/placed.json`, ...args] })
}

export async function example(browser, address) {
  const page = await browser.newPage(), faults = []
  page.on('pageerror', ({ message }) => faults.push(message))
  await page.setViewport({ width: 660, height: 420 })
  await page.goto(`${base}examples/${address}?scene=/work/knot.fxs`)
  async function look(name) {
    const text = await page.screenshot({ encoding: 'base64', clip: { x: 8, y: 8, width: 640, height: 400 } })
    keepPictures({ [name]: text })
    return page.evaluate(`(async () => {
      const image = await createImageBitmap(await (await fetch('data:image/png;base64,${text}')).blob())
      const flat = new OffscreenCanvas(640, 400).getContext('2d', { willReadFrequently: true })
      flat.drawImage(image, 0, 0)
      const words = new Uint32Array(flat.getImageData(0, 0, 640, 400).data.buffer)
      const count = (word) => words.reduce((sum, one) => sum + (one === word ? 1 : 0), 0)
      const empty = [0xff403020, 0xffffffff, 0xff000000].reduce((sum, word) => sum + count(word), 0)
      return { drawn: words.length - empty, marked: count(0xff00ffff) }
    })()`)
  }
  async function until(name, isThere) {
    const end = performance.now() + 120000
    let seen
    do seen = await look(name)
    while (!isThere(seen) && performance.now() < end)
    return seen
  }
  const before = await until(`${address}-before`, ({ drawn }) => drawn >= 50000)
  await page.mouse.click(8 + 150, 8 + 265)
  const after = await until(`${address}-after`, ({ marked }) => marked > 20)
  await page.close()
  assert.deepEqual(faults, [])
  assert.ok(before.drawn >= 50000 && !before.marked, JSON.stringify(before))
  assert.ok(after.marked > 20, JSON.stringify(after))
}
