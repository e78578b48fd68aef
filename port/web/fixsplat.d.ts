/** Whether this machine runs the module with simd128, which is taken then. */
export const hasSimd: boolean

/** Whether that is quicker by a quarter, as machine and browser have relaxed simd128 too: the pictures are the same. */
export const hasRelaxed: boolean

export type Vector = readonly [number, number, number]

export interface LoadOptions {
  /** How a file that is no .fxs is packed: 63.5, 39.6 or 19.6 bytes a Gaussian at SH degree 3. */
  profile?: 'default' | 'compact' | 'small'
  /** Of an .spz: right, up, back; right, down, front; or as the file says. */
  axes?: 'file' | 'rub' | 'rdf'
  /** A scene with more is an Error. Without it: a million, and one for each byte of the file. */
  maxGaussians?: number
  /** Bytes that reading may take. */
  maxMemory?: number
  /** Called now and then while a file is packed, with what is done: 0 to 1. */
  progress?: (done: number) => void
  /** False: the module without simd128. Scenes of one picture have the same, and the same `threads`. */
  simd?: boolean
  /**
   * 1 to 64, the caller's among them; as many as processors, at most 8. There is one without simd128, and in a page that
   * is not isolated: `crossOriginIsolated`, by the headers Cross-Origin-Opener-Policy: same-origin and
   * Cross-Origin-Embedder-Policy: require-corp.
   */
  threads?: number
}

/** Opens a scene: .fxs, .ply (PlayCanvas's compressed one too), .splat, .ksplat, .spz 1 to 3. */
export function load(source: string | URL | ArrayBuffer | ArrayBufferView | Blob, options?: LoadOptions): Promise<Scene>

/** A camera by where it is: y points down, unless `up` says so. */
export interface LookAt {
  /** Without it, the objects are seen whole. */
  eye?: Vector
  /** The middle of the objects. */
  look?: Vector
  /** 0, -1, 0 */
  up?: Vector
  /** Vertical field of view, 1 to 170 degrees; 50. */
  fov?: number
  /** Depth of the near plane; 1/100 of the objects' radius, at most 0.2. */
  near?: number
  width?: number
  height?: number
}

/** A camera as in a cameras.json. */
export interface Pinhole {
  /** Rows; its columns are the camera's axes: x right, y down, z forward. */
  rotation: readonly Vector[]
  position: Vector
  /** Pixels, at `width` x `height`; a picture of another width is the same, smaller or larger. */
  fx: number
  fy?: number
  /** The middle. */
  cx?: number
  cy?: number
  /** 0.2 */
  near?: number
  /** Parallel rays: fx and fy are pixels a unit. */
  orthographic?: boolean
  width?: number
  height?: number
}

export type Camera = LookAt | Pinhole

export interface FrameOptions {
  /** Pixels, 1 to 16384; else the camera's, or 1280 x 720. */
  width?: number
  height?: number
  /** 0xrrggbb; black. */
  background?: number
  /** Colours times coverage, and the coverage as alpha, without a background. */
  alpha?: boolean
  /** The highest that is used, 0 to 3. */
  shDegree?: 0 | 1 | 2 | 3
  cutoff?: 'mahalanobis' | 'square'
  /** Bytes of working memory; with less than all, the same picture takes longer. */
  maxMemory?: number
}

export interface Crop {
  low: Vector
  high: Vector
  keep?: 'inside' | 'outside'
}

/** A scene in the world: translation + scale * rotation * position. */
export interface Placed {
  scene: Scene
  translation?: Vector
  /** A quaternion: w, x, y, z. */
  rotation?: readonly [number, number, number, number]
  scale?: number
  opacity?: number
  tint?: Vector
  visible?: boolean
  id?: number
  crops?: readonly Crop[]
}

export interface Picked {
  /** Its place among the objects. */
  object: number
  gaussian: number
  depth: number
  position: [number, number, number]
}

export class Scene {
  private constructor()
  readonly name: string
  /** Gaussians. */
  readonly count: number
  readonly shDegree: number
  readonly profile: 'default' | 'compact' | 'small'
  /** Where it is seen. */
  readonly low: number[]
  readonly high: number[]
  /** Of the packed scene. */
  readonly bytes: number
  /** How many draw it by now: pictures do not wait for those that have not started yet. */
  readonly threads: number
  /** A copy of it, which is an .fxs file. */
  readonly packed: Uint8Array
  render(camera?: Camera, options?: FrameOptions): Uint8ClampedArray
  pick(x: number, y: number, camera?: Camera, options?: FrameOptions): Picked | null
  /** Gives its memory back. */
  free(): void
}

/** Ends threads that no scene needs, and gives their memory back; without it they wait for the next scene. */
export function end(): Promise<void>

/** Draws objects in one order by depth: RGBA, four bytes a pixel, rows from the top. */
export function render(objects: readonly Placed[], camera?: Camera, options?: FrameOptions): Uint8ClampedArray

/** What a pixel shows: the Gaussian that contributes most. */
export function pick(x: number, y: number, objects: readonly Placed[], camera?: Camera, options?: FrameOptions): Picked | null

/** A .png file of a picture. */
export function png(pixels: Uint8ClampedArray, width: number, height: number): Promise<Uint8Array>
