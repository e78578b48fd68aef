import type { Box3, BufferGeometry, Camera, Material, Mesh, Object3DEventMap, Quaternion } from 'three'
import type { Crop, FrameOptions, LoadOptions, Pinhole, Placed, Scene, Vector } from './fixsplat.js'

/** A renderer of three.js: a WebGLRenderer, or a WebGPURenderer if the browser has WebGPU. */
export interface Renderer {
  readonly domElement: HTMLCanvasElement | OffscreenCanvas
}

/** The events of a Splats, in addition to the events of Object3D. 'change': render again, since parts of a streamed
    scene have arrived or a lost WebGL context was restored. A program that renders all the time need not listen.
    `error` is set if requests of a streamed scene have failed. */
export interface SplatsEventMap extends Object3DEventMap {
  change: { error?: Error }
}

/**
 * A scene of Gaussians as an object of three.js. Its matrixWorld places it, with position, rotation and one scale above
 * 0 for x, y and z. Different scales for the axes are an Error of the render. All Splats that a camera sees in a scene
 * of three.js are sorted and blended together, as one picture. Opaque meshes hide the Gaussians behind them, pixel by
 * pixel, and show through transparent Gaussians in front.
 *
 * The picture is drawn among the transparent objects, at the position in the order of the Splats that was loaded first
 * (`renderOrder`, then the distance of its origin). A transparent mesh is completely under it or completely over it.
 * The picture writes no depth. Its colours are the trained colours, without the tone mapping of a WebGLRenderer.
 */
export class Splats extends Mesh<BufferGeometry, Material, SplatsEventMap> {
  private constructor()
  /**
   * Loads a scene for a renderer, with the options of `load`. `source` may also be a Scene; the caller keeps it and
   * frees it. The scenes of one renderer must be loaded with the same `simd` and the same `threads`. With a
   * WebGPURenderer, scenes are not streamed. The promise is rejected with an Error that states the reason if the scene
   * cannot be opened, or if the renderer has no WebGL 2 and no WebGPU.
   */
  static load(
    renderer: Renderer,
    source: Parameters<typeof import('./fixsplat.js').load>[0] | Scene,
    options?: LoadOptions
  ): Promise<Splats>
  readonly isSplats: true
  readonly scene: Scene
  /** A rotation of the scene before the rotation of the object. Scenes have x right, y down, z forward; three.js has x
      right, y up, z back. The default is therefore half a turn about x. `turn.identity()` keeps the axes of the
      scene. */
  readonly turn: Quaternion
  /** As `Placed.opacity`. */
  opacity: number
  /** As `Placed.tint`. */
  tint: Vector
  /** As `Placed.crops`. */
  crops: readonly Crop[]
  /** Options of the picture. A picture of several Splats uses the options of its first loaded Splats. */
  options: Pick<FrameOptions, 'budget' | 'detail' | 'shDegree' | 'cutoff' | 'maxMemory'>
  /** The box around the visible part of the scene, in the space of the object; Box3.setFromObject reads it. */
  readonly boundingBox: Box3
  /** The object as an argument of fixsplat's functions, placed by its matrixWorld. */
  readonly placed: Required<Omit<Placed, 'visible' | 'id'>>
  /**
   * Needed with a WebGPURenderer only; with a WebGLRenderer it is fulfilled at once. Draws all Splats of this scene for
   * the next `render` with this camera, to the current render target or the canvas. Await it before `render`: WebGPU
   * reports only later that a picture is complete, and `render` alone shows the last picture. The opaque meshes are
   * rendered once more for their depths. On failure, rejected with an Error that states the reason.
   */
  update(camera: Camera): Promise<void>
  /** Makes another object of the same scene. The Gaussians stay in memory once. */
  clone(recursive?: boolean): this
  /** Removes the object from its scene and frees its memory. The last of an object and its clones also frees the
      Gaussians, unless `load` was given a Scene. The last object of a renderer also frees everything that was made in
      the context. Further calls do nothing. */
  dispose(): void
}

/** Converts a camera of three.js, with its matrixWorld and projectionMatrix, to a camera of fixsplat for a picture of
    this size in pixels. An orthographic camera is moved back until its near plane is at a depth of 1. */
export function viewOf(camera: Camera & { near: number }, width: number, height: number): Pinhole
