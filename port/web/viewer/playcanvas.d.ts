import type { AppBase, BoundingBox, CameraComponent, Entity, Quat, Ray, Vec3 } from 'playcanvas'
import type { Crop, FrameOptions, LoadOptions, Pinhole, Placed, Scene, Vector } from 'fixsplat'

/** A scene of Gaussians as an entity of PlayCanvas, for a device of WebGL 2. The world transform places the entity;
    its scales must be equal and above 0. All Splats that a camera sees on a layer are blended together, as one
    picture. Opaque meshes hide the Gaussians behind them.

    The picture is drawn after the opaque meshes of its layer and before the transparent meshes, without depth. The
    tone mapping of a camera does not apply; the tone mapping of a CameraFrame does.

    The event 'change' asks for a new picture, because parts of a streamed scene have arrived or a lost WebGL context
    was restored. The event has an Error if requests have failed. */
export class Splats extends Entity {
  private constructor()
  /** Loads a scene for an application, with the options of `load`. `source` may also be a Scene, which the caller
      keeps and frees. All scenes of an application need the same `simd` and the same `threads`. */
  static load(
    app: AppBase,
    source: Parameters<typeof import('fixsplat').load>[0] | Scene,
    options?: LoadOptions
  ): Promise<Splats>
  readonly isSplats: true
  readonly scene: Scene
  /** A rotation that turns the scene before the entity's own rotation. Scenes have x right, y down, z forward;
      PlayCanvas has x right, y up, z back. The default is therefore half a turn about x. `turn.set(0, 0, 0, 1)`
      keeps the axes of the scene. */
  readonly turn: Quat
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
  /** The ids of the layers that draw the entity; LAYERID_WORLD by default. */
  layers: readonly number[]
  /** The box around the visible part of the scene, in world units. */
  readonly aabb: BoundingBox
  /** This entity in the form that fixsplat's functions, such as `render`, take as argument. Its placement is the world
      transform. */
  readonly placed: Required<Omit<Placed, 'visible' | 'id'>>
  /** Finds the Gaussian of this entity on a ray; null if the ray meets none. With `camera`, the ray must start at
      the camera, and the pixel of the camera's picture is searched. Returns the hit point in world units, its
      distance from the origin of the ray, and the index of the Gaussian. */
  raycast(ray: Ray, camera?: CameraComponent): { point: Vec3; distance: number; index: number } | null
  /** Makes another entity of the same scene, which shares the Gaussians in memory. */
  clone(): this
  /** Removes the entity and its children from the scene and frees their memory. The Gaussians are freed with the
      last clone of the entity, unless `load` was given a Scene. */
  destroy(): void
}

/** Converts a PlayCanvas camera to a fixsplat camera for a picture of this size in pixels. An orthographic camera is
    moved back until its near plane is at depth 1. */
export function viewOf(camera: CameraComponent, width: number, height: number): Pinhole
