// node edit.mjs PACKAGE SCENES MODULES PICTURES COMMAND: edits scenes by hand in the viewer with a scripted mouse. What
// the viewer saves must equal what `convert --edits` makes of its list of edits.
import assert from 'node:assert/strict'
import { execFileSync } from 'node:child_process'
import { readFileSync, writeFileSync } from 'node:fs'
import { resolve } from 'node:path'
import { command, hash, inside, moved, native, open, page, picture, run, scenes, still, viewOf } from './chromium.mjs'

const convert = (...words) => execFileSync(resolve(command), ['convert', ...words, '--quiet'], { cwd: scenes, encoding: 'utf8' })
const factsOf = () => inside(`return [$('chosen').textContent, $('count').textContent]
  .map((text) => Number(text.replace(/[^0-9]/g, '')))`)
const noteOf = () => inside(`return $('note').textContent`)

/** Waits until the answers to all requests are shown. */
async function settled() {
  await inside(`for (let i = 0; i < 3; i++) await v.pick(0, 0)`)
  await moved()
}

async function begin(scene, ...size) {
  await open(`?scene=/scenes/${scene}`, ...size)
  await inside(`v.saved = []
    URL.createObjectURL = (blob) => (v.saved.push(blob), 'data:,')
    $('set').click()
    $('edit').click()`)
  await page.waitForFunction(() => document.querySelector('fixsplat-viewer').shadowRoot.getElementById('tools'))
  await settled()
}

async function drag(points, key) {
  if (key) await page.keyboard.down(key)
  await page.mouse.move(...points[0])
  await page.mouse.down()
  for (const point of points) await page.mouse.move(...point, { steps: 3 })
  await page.mouse.up()
  if (key) await page.keyboard.up(key)
  await settled()
}

async function click(id) {
  await inside(`$('${id}').click()`)
  await settled()
}

async function chord(key, ...held) {
  for (const one of held) await page.keyboard.down(one)
  await page.keyboard.press(key)
  for (const one of held.reverse()) await page.keyboard.up(one)
  await settled()
}

/** Saves the scene and the edits into files, and returns the edits. */
async function save(name) {
  await inside('v.saved = []')
  await click('scene')
  await click('list')
  const [scene, list] = await inside(`return Promise.all(v.saved.map(async (blob) =>
    btoa([...new Uint8Array(await blob.arrayBuffer())].map((byte) => String.fromCharCode(byte)).join(''))))`)
  writeFileSync(`${scenes}/${name}.fxs`, Buffer.from(scene, 'base64'))
  writeFileSync(`${scenes}/${name}.json`, Buffer.from(list, 'base64'))
  return JSON.parse(readFileSync(`${scenes}/${name}.json`, 'utf8'))
}

const bytes = (name) => readFileSync(`${scenes}/${name}`)
const lines = (name) => readFileSync(`${scenes}/${name}`, 'utf8').trim().split('\n').length - 1
const LASSO = [[200, 60], [330, 50], [340, 170], [300, 300], [210, 280]]

await run({
  async 'a lasso: deleted, undone, redone, saved, and done again by convert --edits'() {
    await begin('scene.fxs')
    assert.equal(await inside(`return $('delete').disabled`), true)
    const before = await hash()
    await drag(LASSO)
    const [chosen, all] = await factsOf()
    assert.equal(all, 20000)
    assert.ok(chosen > 3000 && chosen < 12000, chosen)
    await picture('edit-lasso')
    await page.keyboard.press('Delete')
    await settled()
    assert.deepEqual(await factsOf(), [0, all - chosen])
    const deleted = await hash()
    assert.notEqual(deleted, before)
    await picture('edit-deleted')
    await chord('z', 'Control')
    assert.deepEqual(await factsOf(), [0, all])
    assert.equal(await hash(), before)
    await chord('y', 'Control')
    assert.equal(await hash(), deleted)
    const edits = await save('cut')
    assert.equal(edits.edits.length, 1)
    assert.equal(native('cut.fxs', await viewOf(), '640x360'), deleted)
    convert('cut.fxs', 'saved.ply')
    convert('scene.fxs', 'again.ply', '--edits', 'cut.json')
    assert.ok(bytes('saved.ply').equals(bytes('again.ply')))
    convert('scene.ply', 'again.csv', '--edits', 'cut.json')
    assert.equal(lines('again.csv'), all - chosen)
  },

  async 'front only, a brush, a box, a sphere; added and taken out; keep'() {
    await begin('scene.ply')
    await drag(LASSO)
    const [through] = await factsOf()
    await inside(`v.shadowRoot.querySelector('#tools [name=front]').click()`)
    await drag(LASSO)
    const [front] = await factsOf()
    assert.ok(front > through / 10 && front < 0.8 * through, `${front} of ${through}`)
    await click('brush')
    await drag([[390, 80], [420, 200]], 'Shift')
    const [more] = await factsOf()
    assert.ok(more > front)
    await picture('edit-brush')
    await click('sphere')
    await drag([[270, 160], [310, 160]], 'Alt')
    const [less] = await factsOf()
    assert.ok(less < more && less > 0)
    await click('keep')
    assert.deepEqual(await factsOf(), [0, less])
    await picture('edit-kept')
    await click('box')
    await drag([[290, 150], [320, 150]])
    const [box] = await factsOf()
    assert.ok(box > 0 && box < less, `${box} of ${less}`)
    await picture('edit-box')
    await inside(`const field = v.shadowRoot.querySelector('#tools [name=numbers]')
      field.value = '1, 2, 3'
      field.onchange()`)
    assert.match(await noteOf(), /A box has 6 numbers/)
    await click('delete')
    assert.deepEqual(await factsOf(), [0, less - box])
    const edits = await save('kept')
    assert.deepEqual(edits.edits.map(({ act, select }) => [act, ...select.map(({ shape }) => shape)]),
      [['keep', 'lasso', 'brush', 'sphere'], ['delete', 'box']])
    convert('kept.fxs', 'saved.csv')
    convert('scene.ply', 'again.csv', '--edits', 'kept.json')
    assert.equal(lines('again.csv'), lines('saved.csv'))
    convert('scene.fxs', 'again.ply', '--edits', 'kept.json')
    convert('kept.fxs', 'saved.ply')
    assert.ok(bytes('saved.ply').equals(bytes('again.ply')))
    convert('levels.fxs', 'again.ply', '--edits', 'kept.json')   // its leaves are the same chunks
    assert.ok(bytes('saved.ply').equals(bytes('again.ply')))
  },

  async 'an object: clicked, mended, cut, undone, saved, and cut again by convert --edits'() {
    await begin('things.fxs')
    const before = await hash()
    await click('object')
    assert.match(await noteOf(), /Click an object/)
    await drag([[20, 20]])
    assert.match(await noteOf(), /Nothing there/)
    assert.deepEqual(await factsOf(), [0, 7600])
    await drag([[243, 169]])
    const [one] = await factsOf()
    assert.ok(one > 1900 && one < 2001, one)
    await picture('edit-object')
    await drag([[397, 169]])
    const [both] = await factsOf()
    assert.ok(both > 1.8 * one, `${both}, ${one}`)
    await drag([[397, 169]], 'Alt')
    assert.deepEqual(await factsOf(), [one, 7600])
    await page.keyboard.press('Delete')
    await settled()
    assert.deepEqual(await factsOf(), [0, 7600 - one])
    await picture('edit-object-cut')
    const cut = await hash()
    await chord('z', 'Control')
    assert.equal(await hash(), before)
    await picture('edit-object-undone')
    await chord('y', 'Control')
    assert.equal(await hash(), cut)
    const { edits } = await save('object')
    assert.deepEqual(edits.map(({ select }) => select.map(({ shape, points }) => [shape, points.length])), [[['object', 15]]])
    assert.equal(native('object.fxs', await viewOf(), '640x360'), cut)
    convert('object.fxs', 'saved.ply')
    convert('things.fxs', 'again.ply', '--edits', 'object.json')
    assert.ok(bytes('saved.ply').equals(bytes('again.ply')))
    await click('undo')
    await drag([[325, 95], [475, 245]])
    const [boxed] = await factsOf()
    assert.ok(boxed > 1900 && boxed < 2001, boxed)
    await click('keep')
    assert.deepEqual(await factsOf(), [0, boxed])
    await picture('edit-object-kept')
  },

  async 'a narrow page; the tools leave the camera to other buttons; a page without `edit` has none'() {
    await begin('scene.fxs', 390, 844)
    await picture('edit-narrow')
    const view = await viewOf()
    await drag([[150, 300], [250, 300], [200, 400]])
    assert.equal(await viewOf(), view)
    await page.mouse.move(200, 300)
    await page.mouse.down({ button: 'right' })
    await page.mouse.move(240, 300, { steps: 3 })
    await page.mouse.up({ button: 'right' })
    await settled()
    assert.notEqual(await viewOf(), view)
    await chord('Escape')
    await chord('Escape')
    assert.equal(await inside(`return $('tools').hidden`), true)
    await inside(`v.removeAttribute('edit')`)
    assert.equal(await inside(`return $('edit').hidden`), true)
    const isHidden = await inside(`
      const element = document.createElement('fixsplat-viewer')
      element.setAttribute('edit', '')
      document.body.append(element)
      const is = element.shadowRoot.getElementById('edit').hidden
      element.remove()
      return is`)
    assert.equal(isHidden, false, 'the attribute, set before the element is in the page')
    await still()
  },
})
