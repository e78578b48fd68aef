import type { AppBase, BoundingBox, CameraComponent, Entity, Quat, Ray, Vec3 } from 'playcanvas'
import type { Crop, FrameOptions, LoadOptions, Pinhole, Placed, Scene, Vector } from './fixsplat.js'

/**
 * A scene of Gaussians as an entity of PlayCanvas. The application needs a device of WebGL 2. The world transform
 * places the entity, with position, rotation and one scale above 0 for x, y and z. Different scales for the axes are an
 * Error of the frame. All Splats that a camera sees on a layer are sorted and blended together, as one picture. Opaque
 * meshes hide the Gaussians behind them, pixel by pixel, and show through transparent Gaussians in front.
 *
 * The picture is drawn after the opaque meshes of its layer and before the transparent ones. It writes no depth. Its
 * colours are the trained colours, without the tone mapping of a camera; the tone mapping of a CameraFrame applies.
 *
 * The event 'change' asks for a new picture: parts of a streamed scene have arrived, or a lost WebGL context was
 * restored. It has an Error if requests of a streamed scene have failed. An application that renders all the time need
 * not listen.
 */
export class Splats extends Entity {
  private constructor()
  /**
   * Loads a scene for an application, with the options of `load`. `source` may also be a Scene; the caller keeps it and
   * frees it. The scenes of one application must be loaded with the same `simd` and the same `threads`. The promise is
   * rejected with an Error that states the reason if the scene cannot be opened, or if the application has no WebGL 2.
   */
  static load(
    app: AppBase,
    source: Parameters<typeof import('./fixsplat.js').load>[0] | Scene,
    options?: LoadOptions
  ): Promise<Splats>
  readonly isSplats: true
  readonly scene: Scene
  /** A rotation of the scene before the rotation of the entity. Scenes have x right, y down, z forward; PlayCanvas has
      x right, y up, z back. The default is therefore half a turn about x. `turn.set(0, 0, 0, 1)` keeps the axes of the
      scene. */
  readonly turn: Quat
  /** As `Placed.opacity`. */
  opacity: number
  /** As `Placed.tint`. */
  tint: Vector
  /** As `Placed.crops`. */
  crops: readonly Crop[]
  /** Options of the picture. A picture of several Splats uses the options of its first loaded Splats. */
  options: Pick<FrameOptions, 'budget' | 'detail' | 'shDegree' | 'cutoff' | 'maxMemory'>
  /** The ids of the layers that draw the entity; LAYERID_WORLD by default. */
  layers: readonly number[]
  /** The box around the visible part of the scene, in world units. */
  readonly aabb: BoundingBox
  /** The entity as an argument of fixsplat's functions, placed by its world transform. */
  readonly placed: Required<Omit<Placed, 'visible' | 'id'>>
  /** Finds the Gaussian of this entity at a ray; null if the ray meets none. With `camera`, the ray must start at the
      camera, and `pick` is called for its pixel of the camera's picture. Without, it is called for a pixel of 1/1000
      radian along the ray. Returns the point in world units, the distance from the origin of the ray, and the index of
      the Gaussian. */
  raycast(ray: Ray, camera?: CameraComponent): { point: Vec3; distance: number; index: number } | null
  /** Makes another entity of the same scene. The Gaussians stay in memory once. */
  clone(): this
  /** Removes the entity and its children from the scene and frees its memory. The last of an entity and its clones also
      frees the Gaussians, unless `load` was given a Scene. The last entity of an application also frees everything that
      was made in the context. */
  destroy(): void
}

/** Converts a camera of PlayCanvas, with the world transform of its entity and its projectionMatrix, to a camera of
    fixsplat for a picture of this size in pixels. An orthographic camera is moved back until its near plane is at a
    depth of 1. */
export function viewOf(camera: CameraComponent, width: number, height: number): Pinhole
