// A mesh of three.js that stands in a scene of Gaussians, drawn by one WebGPU device: in a page with an import map for
// `three/webgpu` and `fixsplat`, and a <canvas>.
import * as THREE from 'three/webgpu'
import { load, Screen } from 'fixsplat'

const FOV = 50
const [NEAR, FAR] = [0.1, 100]

/** Opens a scene on a canvas; `draw` shows one picture. */
export async function open(canvas, address) {
  THREE.ColorManagement.enabled = false          // colours as they are shown, which those of the scene are too
  const { width, height } = canvas
  const renderer = new THREE.WebGPURenderer({ canvas, outputColorSpace: THREE.LinearSRGBColorSpace })
  await renderer.init()
  renderer.setSize(width, height, false)
  const target = new THREE.RenderTarget(width, height, { depthTexture: new THREE.DepthTexture(width, height) })
  const textureOf = (texture) => renderer.backend.get(texture).texture         // three's as WebGPU's

  const world = new THREE.Scene()
  world.background = new THREE.Color(0x203040)
  const mesh = new THREE.Mesh(new THREE.BoxGeometry(1, 1, 1), new THREE.MeshBasicMaterial({ color: 0xff8000 }))
  world.add(mesh)
  const camera = new THREE.PerspectiveCamera(FOV, width / height, NEAR, FAR)
  const shown = new THREE.QuadMesh(new THREE.MeshBasicMaterial({ map: target.texture }))

  const screen = await Screen.open(null, 'webgpu', { device: renderer.backend.device })
  const scene = await load(address)
  const placed = [{ scene, rotation: [0, 1, 0, 0] }]         // scenes have y down, three has y up

  async function draw(eye, look) {
    camera.position.set(...eye)
    camera.lookAt(...look)
    renderer.setRenderTarget(target)
    renderer.render(world, camera)
    const depth = { texture: textureOf(target.depthTexture), planes: [NEAR, FAR] }
    const into = { texture: textureOf(target.texture), depth, over: true }
    const view = { eye, look, up: [0, 1, 0], fov: FOV, near: NEAR }
    screen.draw(placed, view, { width, height, alpha: true, into })
    await screen.finish()
    renderer.setRenderTarget(null)
    shown.render(renderer)
  }

  return { draw, mesh, renderer, target, screen, placed }
}
