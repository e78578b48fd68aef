import type { Box3, BufferGeometry, Camera, Material, Mesh, Object3DEventMap, Quaternion } from 'three'
import type { Crop, FrameOptions, LoadOptions, Pinhole, Placed, Scene, Vector } from 'fixsplat'

/** A renderer of three.js: a WebGLRenderer, or a WebGPURenderer in a browser with WebGPU. */
export interface Renderer {
  readonly domElement: HTMLCanvasElement | OffscreenCanvas
}

/** The events of a Splats object. The event 'change' asks for a new render, because parts of a streamed scene have
    arrived or a lost WebGL context was restored. `error` is set if requests have failed. */
export interface SplatsEventMap extends Object3DEventMap {
  change: { error?: Error }
}

/** A scene of Gaussians as an object of three.js. The matrixWorld places the object; its scales must be equal and
    above 0. All Splats that a camera sees in a three.js scene are blended together, as one picture. Opaque meshes
    hide the Gaussians behind them.

    The picture takes the place of the first loaded Splats among the transparent objects. A transparent mesh is
    completely under the picture or completely over it. The picture writes no depth. The tone mapping of a
    WebGLRenderer does not apply. */
export class Splats extends Mesh<BufferGeometry, Material, SplatsEventMap> {
  private constructor()
  /** Loads a scene for a renderer, with the options of `load`. `source` may also be a Scene, which the caller keeps
      and frees. All scenes of a renderer need the same `simd` and the same `threads`. A WebGPURenderer does not
      stream scenes. */
  static load(
    renderer: Renderer,
    source: Parameters<typeof import('fixsplat').load>[0] | Scene,
    options?: LoadOptions
  ): Promise<Splats>
  readonly isSplats: true
  readonly scene: Scene
  /** A rotation that turns the scene before the object's own rotation. Scenes have x right, y down, z forward;
      three.js has x right, y up, z back. The default is therefore half a turn about x. `turn.identity()` keeps the
      axes of the scene. */
  readonly turn: Quaternion
  /** A factor for the opacity of all Gaussians, 0 to 1; 1 by default. */
  opacity: number
  /** Factors for red, green and blue, 0 to 4 each; [1, 1, 1] by default. */
  tint: Vector
  /** At most 8 crop boxes in scene coordinates; see `Placed.crops`. */
  crops: readonly Crop[]
  /** The moment of a moving scene in seconds; 0 by default. Set the time before each render to play the scene. */
  time: number
  /** Options for drawing. A picture of several Splats objects uses the options of the object that was loaded first. */
  options: Pick<FrameOptions, 'budget' | 'detail' | 'shDegree' | 'cutoff' | 'maxMemory'>
  /** The box around the visible part of the scene, in the space of the object. Box3.setFromObject reads this box. */
  readonly boundingBox: Box3
  /** This object in the form that fixsplat's functions, such as `render`, take as argument. Its placement is the
      matrixWorld. */
  readonly placed: Required<Omit<Placed, 'visible' | 'id'>>
  /** Draws all Splats of this scene for the next `render` with this camera, to the current render target or the
      canvas. Only a WebGPURenderer needs this call; await the promise before `render`. The opaque meshes are
      rendered once more for their depths. */
  update(camera: Camera): Promise<void>
  /** Makes another object of the same scene, which shares the Gaussians in memory. */
  clone(recursive?: boolean): this
  /** Removes the object from its scene and frees its memory. The Gaussians are freed with the last clone of the
      object, unless `load` was given a Scene. Further calls do nothing. */
  dispose(): void
}

/** Converts a three.js camera to a fixsplat camera for a picture of this size in pixels. An orthographic camera is
    moved back until its near plane is at depth 1. */
export function viewOf(camera: Camera & { near: number }, width: number, height: number): Pinhole
