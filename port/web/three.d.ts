import type { Box3, BufferGeometry, Camera, Material, Mesh, Object3DEventMap, Quaternion } from 'three'
import type { Crop, FrameOptions, LoadOptions, Pinhole, Placed, Scene, Vector } from './fixsplat.js'

/** A renderer of three.js: a WebGLRenderer, or a WebGPURenderer in a browser with WebGPU. */
export interface Renderer {
  readonly domElement: HTMLCanvasElement | OffscreenCanvas
}

/** The events of Splats, in addition to the events of Object3D. The event 'change' asks for a new render, because
    parts of a streamed scene have arrived or a lost WebGL context was restored. A program that renders continuously
    need not listen. `error` is set if requests of a streamed scene have failed. */
export interface SplatsEventMap extends Object3DEventMap {
  change: { error?: Error }
}

/** A scene of Gaussians as an object of three.js. The matrixWorld places the object. The scales of x, y and z must
    be equal and above 0, else the render throws an Error. All Splats that a camera sees in a three.js scene are
    sorted and blended together, as one picture. Opaque meshes hide the Gaussians behind them, pixel by pixel, and
    show through transparent Gaussians in front.

    The picture takes the place of the first loaded Splats among the transparent objects, by `renderOrder`, then by
    distance. A transparent mesh is completely under the picture or completely over it. The picture writes no depth.
    Its colours are the trained colours, without the tone mapping of a WebGLRenderer. */
export class Splats extends Mesh<BufferGeometry, Material, SplatsEventMap> {
  private constructor()
  /** Loads a scene for a renderer, with the options of `load`. `source` may also be a Scene, which the caller keeps
      and frees. All scenes of a renderer need the same `simd` and the same `threads`. A WebGPURenderer does not
      stream scenes. The promise is rejected with an Error if the scene cannot be opened, or if the renderer has no
      WebGL 2 and no WebGPU. */
  static load(
    renderer: Renderer,
    source: Parameters<typeof import('./fixsplat.js').load>[0] | Scene,
    options?: LoadOptions
  ): Promise<Splats>
  readonly isSplats: true
  readonly scene: Scene
  /** The rotation of the scene before the rotation of the object. Scenes have x right, y down, z forward; three.js
      has x right, y up, z back. The default is therefore half a turn about x. `turn.identity()` keeps the axes of
      the scene. */
  readonly turn: Quaternion
  /** A factor for the opacity, as `Placed.opacity`. */
  opacity: number
  /** Factors for red, green and blue, as `Placed.tint`. */
  tint: Vector
  /** Crop boxes in scene coordinates, as `Placed.crops`. */
  crops: readonly Crop[]
  /** Options of the picture. A picture of several Splats uses the options of the first loaded Splats. */
  options: Pick<FrameOptions, 'budget' | 'detail' | 'shDegree' | 'cutoff' | 'maxMemory'>
  /** The box around the visible part of the scene, in the space of the object. Box3.setFromObject reads this box. */
  readonly boundingBox: Box3
  /** The object as an argument of fixsplat's functions, placed by its matrixWorld. */
  readonly placed: Required<Omit<Placed, 'visible' | 'id'>>
  /** Draws all Splats of this scene for the next `render` with this camera, to the current render target or the
      canvas. Only a WebGPURenderer needs this call. Await the promise before `render`, which otherwise shows the
      last picture, because WebGPU reports only later that a picture is complete. The opaque meshes are rendered once
      more for their depths. On failure, the promise is rejected with an Error. */
  update(camera: Camera): Promise<void>
  /** Makes another object of the same scene, which shares the Gaussians in memory. */
  clone(recursive?: boolean): this
  /** Removes the object from its scene and frees its memory. The Gaussians are freed with the last clone of the
      object, unless `load` was given a Scene. The last object of a renderer also frees everything that was made in
      the context. Further calls do nothing. */
  dispose(): void
}

/** Converts a three.js camera to a fixsplat camera for a picture of this size in pixels. The matrixWorld and the
    projectionMatrix are used. An orthographic camera is moved back until its near plane is at depth 1. */
export function viewOf(camera: Camera & { near: number }, width: number, height: number): Pinhole
