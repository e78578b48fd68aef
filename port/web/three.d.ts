import type { Box3, BufferGeometry, Camera, Material, Mesh, Object3DEventMap, Quaternion } from 'three'
import type { Crop, FrameOptions, LoadOptions, Pinhole, Placed, Scene, Vector } from './fixsplat.js'

/** A renderer of three.js: its WebGLRenderer, or its WebGPURenderer where there is WebGPU. */
export interface Renderer {
  readonly domElement: HTMLCanvasElement | OffscreenCanvas
}

/** The events that a Splats has beside those of every object of three.js. 'change': a picture would be another now, as
    parts of a scene that comes in parts have arrived, or as a lost WebGL context is there again. A program that renders
    all the time need not listen. `error` says why no more parts come, where that is so. */
export interface SplatsEventMap extends Object3DEventMap {
  change: { error?: Error }
}

/**
 * A scene of Gaussians as an object of three.js. It is placed by its matrixWorld, as every object is: position,
 * rotation, and one scale above 0 for x, y and z; another is an Error of the render. All Splats that a camera sees in a
 * scene of three.js are sorted and blended together, as one picture. Meshes that are opaque hide what lies behind them,
 * pixel by pixel, and are seen through what is not opaque.
 *
 * The picture is drawn among the transparent objects, where three.js draws the Splats that was loaded first
 * (`renderOrder`, then the distance of its origin). A transparent mesh is wholly under it or wholly over it. It writes
 * no depth. Its colours are as they were trained, without the tone mapping of a WebGLRenderer.
 */
export class Splats extends Mesh<BufferGeometry, Material, SplatsEventMap> {
  private constructor()
  /**
   * Loads a scene for a renderer, with the options of `load`. `source` may also be a Scene, which stays the caller's.
   * The scenes of one renderer must be loaded with the same `simd` and the same `threads`. With a WebGPURenderer a
   * scene is downloaded whole, never in parts. The promise is rejected with an Error that states the reason where the
   * scene cannot be opened, or the renderer has neither WebGL 2 nor WebGPU.
   */
  static load(
    renderer: Renderer,
    source: Parameters<typeof import('./fixsplat.js').load>[0] | Scene,
    options?: LoadOptions
  ): Promise<Splats>
  readonly isSplats: true
  readonly scene: Scene
  /** What turns the axes of the scene, before the object's own rotation. Scenes have x right, y down, z forward, and
      three.js has x right, y up, z back: by default half a turn about x. `turn.identity()` takes a scene as it is. */
  readonly turn: Quaternion
  /** As those of `Placed`. */
  opacity: number
  tint: Vector
  crops: readonly Crop[]
  /** Those of the Splats that was loaded first hold for the picture of all: budget, detail, shDegree, cutoff. */
  options: Pick<FrameOptions, 'budget' | 'detail' | 'shDegree' | 'cutoff' | 'maxMemory'>
  /** The box around the visible part of the scene, in the object's own space; Box3.setFromObject reads it. */
  readonly boundingBox: Box3
  /** The object as fixsplat's functions take it, by its matrixWorld. */
  readonly placed: Required<Omit<Placed, 'visible' | 'id'>>
  /**
   * With a WebGPURenderer: draws the Splats of the scene in which this one is, for the next `render` with this camera,
   * to the current render target or the canvas. WebGPU says only later whether a picture is whole, so it is awaited;
   * without it, `render` shows the last picture. The opaque meshes are rendered once more for their depths. Rejected
   * with an Error that states the reason. With a WebGLRenderer `render` alone does all, and `update` is fulfilled at
   * once.
   */
  update(camera: Camera): Promise<void>
  /** Another object of the same scene, whose Gaussians are in memory once. */
  clone(recursive?: boolean): this
  /** Takes the object out of its scene and frees its memory; the last one of an object and its clones frees the
      Gaussians, unless `load` was given a Scene, and the last one of a renderer frees all that was made in its context.
      It may be called again. */
  dispose(): void
}

/** A camera of three.js, by its matrixWorld and its projectionMatrix, as fixsplat's functions take it, for a picture of
    this size in pixels. An orthographic one is moved back until its near plane is at a depth of 1. */
export function viewOf(camera: Camera & { near: number }, width: number, height: number): Pinhole
