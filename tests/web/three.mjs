// What webgl.mjs and webgpu.mjs ask of fixsplat/three.
import assert from 'node:assert/strict'
import { mkdirSync, writeFileSync } from 'node:fs'
import { frame, hashOf, runIn } from './screens.mjs'

const [WIDTH, HEIGHT] = [160, 100]
// As the command sees what the page's camera sees: three.js has y up and z back.
const seen = frame('knot', WIDTH, HEIGHT, ['--eye', '0,-1,-4', '--look', '0,0,0', '--near', '0.1'])

/** A renderer, a scene and a camera in the page, and what is asked of them. */
const STAGE = `const THREE = await import('three'), { Splats, viewOf } = await import('fixsplat/three')
  const { render, pick } = await import('fixsplat')
  const [width, height] = [${WIDTH}, ${HEIGHT}], RED = [255, 0, 0, 255]
  const flat = new OffscreenCanvas(width, height).getContext('2d', { willReadFrequently: true })
  function shown(canvas) {
    flat.clearRect(0, 0, width, height)
    flat.drawImage(canvas, 0, 0)
    return flat.getImageData(0, 0, width, height).data
  }
  const pictures = {}
  async function keep(name, canvas) {
    const copy = new OffscreenCanvas(canvas.width, canvas.height)
    copy.getContext('2d').drawImage(canvas, 0, 0)
    const bytes = new Uint8Array(await (await copy.convertToBlob()).arrayBuffer())
    pictures[name] = btoa(String.fromCharCode(...bytes))
  }
  function cameraOf(kind = 'perspective') {
    const camera = kind === 'perspective' ? new THREE.PerspectiveCamera(50, width / height, 0.1, 100)
      : new THREE.OrthographicCamera(-3.2, 3.2, 2, -2, -10, 60)
    camera.position.set(0, 1, 4)
    camera.lookAt(0, 0, 0)
    camera.updateMatrixWorld()
    return camera
  }
  /** A wall that faces the camera, so that all of it has one depth. */
  function wall(camera, distance, color = 0xff0000, side = 1.2) {
    const material = new THREE.MeshBasicMaterial({ color })
    const mesh = new THREE.Mesh(new THREE.PlaneGeometry(side, side), material)
    mesh.quaternion.copy(camera.quaternion)
    mesh.position.copy(camera.position).addScaledVector(camera.getWorldDirection(new THREE.Vector3()), distance)
    return mesh
  }
  const apart = (a, b) => a.reduce((most, byte, i) => Math.max(most, Math.abs(byte - b[i])), 0)
  const at = (bytes, i) => [...bytes.slice(4 * i, 4 * i + 4)]`

/** Writes the page's pictures where PICTURES says. */
function keepPictures(pictures) {
  const folder = process.env.PICTURES
  if (folder) mkdirSync(folder, { recursive: true })
  for (const [name, text] of folder ? Object.entries(pictures) : [])
    writeFileSync(`${folder}/${name}.png`, Buffer.from(text, 'base64'))
}

export const threeTests = (browser) => ({
  async 'three.js: splats alone have the bytes of the command'() {
    const [hashes, pictures] = await runIn(browser, 'mesh', `${STAGE}
      const hashes = []
      for (const antialias of [false, true]) {
        const renderer = new THREE.WebGLRenderer({ antialias })
        renderer.setSize(width, height)
        const scene = new THREE.Scene(), camera = cameraOf(), splats = await Splats.load(renderer, '/work/knot.fxs')
        scene.background = new THREE.Color(0)
        scene.add(splats)
        renderer.render(scene, camera)
        hashes.push(hash(shown(renderer.domElement)), renderer.getContext().getError())
        await keep('alone-' + antialias, renderer.domElement)
      }
      return [hashes, pictures]`)
    keepPictures(pictures)
    assert.deepEqual(hashes, [hashOf(seen), 0, hashOf(seen), 0])
  },

  async 'three.js: a mesh before, behind and amid splats'() {
    const [found, pictures] = await runIn(browser, 'mesh', `${STAGE}
      // What is drawn into: the canvas or targets, whose colours are light, so that only opaque ones are bytes.
      const target = (how) => new THREE.WebGLRenderTarget(width, height, how)
      const depthTexture = new THREE.DepthTexture(width, height, THREE.FloatType)
      const ways = {
        plain: [{}],
        multisampled: [{ antialias: true }],
        orthographic: [{}, 'orthographic'],
        logarithmic: [{ logarithmicDepthBuffer: true }],
        reversed: [{ reversedDepthBuffer: true }],
        'reversed and orthographic': [{ reversedDepthBuffer: true }, 'orthographic'],
        'a target': [{}, 'perspective', target({ type: THREE.HalfFloatType })],
        'a target of halves, multisampled': [{}, 'perspective', target({ samples: 4, type: THREE.HalfFloatType })],
        'a target with a stencil': [{}, 'perspective', target({ type: THREE.HalfFloatType, stencilBuffer: true })],
        'a target with a texture of depths': [{}, 'perspective', target({ type: THREE.HalfFloatType, depthTexture })],
      }
      const found = {}
      for (const [name, [how, kind, into]] of Object.entries(ways)) {
        const renderer = new THREE.WebGLRenderer(how), scene = new THREE.Scene(), camera = cameraOf(kind)
        renderer.setSize(width, height)
        const splats = await Splats.load(renderer, '/work/knot.fxs')
        const shows = new THREE.Mesh(new THREE.PlaneGeometry(2, 2), new THREE.MeshBasicMaterial({ map: into?.texture }))
        scene.background = new THREE.Color(0)
        scene.add(splats)
        function draw(...meshes) {
          scene.add(...meshes)
          renderer.setRenderTarget(into ?? null)
          renderer.render(scene, camera)
          renderer.setRenderTarget(null)
          if (into) renderer.render(shows, new THREE.Camera())
          meshes.forEach((mesh) => scene.remove(mesh))
          return shown(renderer.domElement)
        }
        const redAlone = (...meshes) => {
          splats.visible = false
          const bytes = draw(...meshes)
          splats.visible = true
          return bytes
        }
        // The most that a pixel is from premultiplied splats over a mesh, where there is all of the mesh or nothing.
        const back = kind === 'orthographic' ? 11 : 0, view = viewOf(camera, width, height)
        found[name] = [2, 4.03, 8].map((distance) => {
          const mesh = wall(camera, distance, 0xff0000, kind === 'orthographic' ? 1.6 : 0.4 * distance)
          const red = redAlone(mesh), shows = draw(mesh), occluder = new Uint32Array(width * height).fill(0xffffffff)
          occluder.forEach((_, i) => red[4 * i] && (occluder[i] = (distance + back) * 2 ** 20))
          const targets = { colour: 'premultiplied', occluder }
          const { colour } = render([splats.placed], view, { width, height, depthBits: 20, targets })
          let most = 0, whole = 0, hidden = 0
          occluder.forEach((_, i) => {
            const coverage = colour[4 * i + 3], isLight = into && coverage > 0 && coverage < 255
            if (![0, 255].includes(red[4 * i]) || isLight) return
            if (red[4 * i]) coverage ? whole++ : hidden++
            for (const c of [0, 1, 2]) {
              const wanted = colour[4 * i + c] + red[4 * i + c] * (1 - coverage / 255)
              most = Math.max(most, Math.abs(Math.min(255, wanted) - shows[4 * i + c]))
            }
          })
          return { most, whole, hidden }
        })
        const amid = wall(camera, 4.03, 0xff0000, 1.6)
        draw(amid)
        await keep(name, renderer.domElement)
        splats.dispose()
        renderer.dispose()
      }
      return [found, pictures]`)
    keepPictures(pictures)
    console.log(found)
  },
})
