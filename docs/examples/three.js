// Shows Gaussians in a three.js scene: a torus knot passes through them, and a click marks a point.
import * as THREE from 'three'
import { Splats } from 'fixsplat-viewer/three'

/** Fills a scene for a WebGLRenderer or a WebGPURenderer. `draw` shows one picture; `click` marks the surface at a
   pixel. */
export async function open(renderer, address) {
  const canvas = renderer.domElement
  const scene = new THREE.Scene()
  scene.background = new THREE.Color(0x203040)
  const camera = new THREE.PerspectiveCamera(50, canvas.width / canvas.height, 0.1, 100)
  camera.position.set(0, 1, 5)
  camera.lookAt(0, 0, 0)

  const splats = await Splats.load(renderer, address)
  const second = splats.clone()
  second.position.set(1.6, 1.2, -1)
  second.scale.setScalar(0.4)
  const knot = new THREE.Mesh(new THREE.TorusKnotGeometry(1, 0.15, 128, 16), new THREE.MeshNormalMaterial())
  const mark = new THREE.Mesh(new THREE.SphereGeometry(0.1), new THREE.MeshBasicMaterial({ color: 0xffff00 }))
  mark.visible = false
  scene.add(splats, second, knot, mark)

  const raycaster = new THREE.Raycaster()
  function click({ clientX, clientY }) {
    const { left, top, width, height } = canvas.getBoundingClientRect()
    const at = new THREE.Vector2((2 * (clientX - left)) / width - 1, 1 - (2 * (clientY - top)) / height)
    raycaster.setFromCamera(at, camera)
    const [hit] = raycaster.intersectObjects([splats, second, knot])
    mark.visible = !!hit
    if (hit) mark.position.copy(hit.point)
    return hit
  }

  /** WebGPU reports only later whether the splats are complete. WebGL does not wait. */
  async function draw() {
    await splats.update(camera)
    renderer.render(scene, camera)
  }

  canvas.addEventListener('click', click)
  return { scene, camera, splats, second, knot, mark, click, draw }
}
