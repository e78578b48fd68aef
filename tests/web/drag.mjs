// node drag.mjs PACKAGE SCENES MODULES PICTURES COMMAND [SECONDS [SCENE [WIDTHxHEIGHT]]]: drags a scene in the viewer
// with the mouse, and prints sizes and times of the pictures. Old packages give the event `frame` another name, which
// the environment variable EVENT sets.
import { go, page, pause, still, inside, run } from './chromium.mjs'

const [seconds = 60, scene = 'real/snowmiku/snowmiku.ply', size = '800x450'] = process.argv.slice(7)
const [width, height] = size.split('x').map(Number)
const part = (list, p) => list[Math.min(list.length - 1, Math.floor(p * list.length))]

function shares(values) {
  const counts = new Map()
  for (const value of values) counts.set(value, (counts.get(value) ?? 0) + 1)
  const sorted = [...counts].sort(([a], [b]) => a - b)
  return sorted.map(([value, count]) => `${value}: ${((100 * count) / values.length).toFixed(1)} %`).join(', ')
}

await run({
  async drag() {
    await go(`?scene=/scenes/${scene}`, width, height)
    await still()
    await pause(1000)
    const name = process.env.EVENT ?? 'frame'
    await inside(`v.seen = []; v.addEventListener('${name}', ({ detail }) => v.seen.push([performance.now(), detail]))`)
    await page.mouse.move(width / 2, height / 2)
    await page.mouse.down()
    const start = Date.now()
    for (let i = 0; Date.now() - start < 1000 * seconds; i++) {
      await page.mouse.move(width / 2 + 0.3 * width * Math.sin(i / 40), height / 2 + 0.1 * height * Math.sin(i / 70))
      await pause(15)
    }
    const seen = await inside('return v.seen')
    await page.mouse.up()
    const facts = seen.map(([, detail]) => detail)
    const gaps = seen.slice(1).map(([at], i) => at - seen[i][0]).sort((a, b) => a - b)
    const times = facts.map(({ milliseconds }) => milliseconds).sort((a, b) => a - b)
    const turns = facts.filter(({ divisor }, i) => i && divisor !== facts[i - 1].divisor).length
    const span = (seen.at(-1)[0] - seen[0][0]) / 1000
    console.log(`${seen.length} pictures in ${span.toFixed(1)} s: ${(seen.length / span).toFixed(1)} a second`)
    const parts = (list, ...places) => places.map((p) => part(list, p / 100).toFixed(0)).join(', ')
    console.log(`milliseconds of a picture: ${parts(times, 10, 50, 90)} (10, 50, 90 %)`)
    console.log(`between two: ${parts(gaps, 10, 50, 90, 99)} (10, 50, 90, 99 %)`)
    console.log(`divisors: ${shares(facts.map(({ divisor }) => divisor))}; ${turns} changes`)
  },
})
