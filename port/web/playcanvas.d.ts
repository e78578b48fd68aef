import type { AppBase, BoundingBox, CameraComponent, Entity, Quat, Ray, Vec3 } from 'playcanvas'
import type { Crop, FrameOptions, LoadOptions, Pinhole, Placed, Scene, Vector } from './fixsplat.js'

/**
 * A scene of Gaussians as an entity of PlayCanvas, in an application with a device of WebGL 2. It is placed by its world
 * transform, as every entity is: position, rotation, and one scale above 0 for x, y and z; another is an Error of the
 * frame. All Splats that a camera sees on a layer are sorted and blended together, as one picture. Meshes that are
 * opaque hide what lies behind them, pixel by pixel, and are seen through what is not opaque.
 *
 * The picture is drawn after the opaque meshes of its layer and before all that are transparent. It writes no depth.
 * Its colours are as they were trained, without the tone mapping of a camera; that of a CameraFrame holds for them too.
 *
 * The event 'change' says that a picture would be another now, as parts of a scene that comes in parts have arrived, or
 * as a lost WebGL context is there again; with an Error where no more parts come. An application that renders all the
 * time need not listen.
 */
export class Splats extends Entity {
  private constructor()
  /**
   * Loads a scene for an application, with the options of `load`. `source` may also be a Scene, which stays the
   * caller's. The scenes of one application must be loaded with the same `simd` and the same `threads`. The promise is
   * rejected with an Error that states the reason where the scene cannot be opened, or the application has no WebGL 2.
   */
  static load(
    app: AppBase,
    source: Parameters<typeof import('./fixsplat.js').load>[0] | Scene,
    options?: LoadOptions
  ): Promise<Splats>
  readonly isSplats: true
  readonly scene: Scene
  /** What turns the axes of the scene, before the entity's own rotation. Scenes have x right, y down, z forward, and
      PlayCanvas has x right, y up, z back: by default half a turn about x. `turn.set(0, 0, 0, 1)` takes a scene as it
      is. */
  readonly turn: Quat
  /** As those of `Placed`. */
  opacity: number
  tint: Vector
  crops: readonly Crop[]
  /** Those of the Splats that was loaded first hold for the picture of all: budget, detail, shDegree, cutoff. */
  options: Pick<FrameOptions, 'budget' | 'detail' | 'shDegree' | 'cutoff' | 'maxMemory'>
  /** The numbers of the layers on which it is drawn, by default that of LAYERID_WORLD. */
  layers: readonly number[]
  /** The box around the visible part of the scene, in the world. */
  readonly aabb: BoundingBox
  /** The entity as fixsplat's functions take it, by its world transform. */
  readonly placed: Required<Omit<Placed, 'visible' | 'id'>>
  /** The Gaussian that `pick` finds of this object, whose number is `index`, where a ray meets it: at the ray's pixel of
      the picture of `camera`, from which the ray must come, else through a pixel of a thousandth radian. `distance` is
      that from the ray's origin. null where there is none. */
  raycast(ray: Ray, camera?: CameraComponent): { point: Vec3; distance: number; index: number } | null
  /** Another entity of the same scene, whose Gaussians are in memory once. */
  clone(): this
  /** Takes the entity and its children out of the scene and frees its memory; the last one of an entity and its clones
      frees the Gaussians, unless `load` was given a Scene, and the last one of an application frees all that was made in
      its context. */
  destroy(): void
}

/** A camera of PlayCanvas, by its entity's world transform and its projectionMatrix, as fixsplat's functions take it,
    for a picture of this size in pixels. An orthographic one is moved back until its near plane is at a depth of 1. */
export function viewOf(camera: CameraComponent, width: number, height: number): Pinhole
