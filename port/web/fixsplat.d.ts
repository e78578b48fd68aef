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
  /** Called now and then. */
  progress?: (progress: Progress) => void
  /** Called with a scene of what has come so far, at most 100,000 Gaussians of it without SH, larger than they are:
      while a .ply, .splat, .ksplat or compressed .ply comes from a server that says how long it is, and before a large
      scene of any format but .fxs is packed. The scene is yours to free. What is returned is waited for. */
  preview?: (scene: Scene) => void | Promise<void>
  /** False: the module without simd128. Scenes of one picture have the same, and the same `threads`. */
  simd?: boolean
  /**
   * 1 to 64, the caller's among them; as many as processors, at most 8. There is one without simd128, and in a page that
   * is not isolated: `crossOriginIsolated`, by the headers Cross-Origin-Opener-Policy: same-origin and
   * Cross-Origin-Embedder-Policy: require-corp.
   */
  threads?: number
}

export interface Progress {
  stage: 'download' | 'prepare'
  /** 0 to 1, where it is known. */
  done?: number
  /** Of a download, so far. */
  bytes?: number
}

/** Opens a scene: @FORMATS@.
    Files that it names are fetched from beside it, or are in the same list of files, by their
    webkitRelativePath or name. */
export function load(
  source: string | URL | ArrayBuffer | ArrayBufferView | Blob | Iterable<File>,
  options?: LoadOptions
): Promise<Scene>

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

/** What a frame has beside colours, or in place of them; each named one is there, and the rest costs nothing. */
export interface Targets {
  /** True: RGBA8, or premultiplied with `alpha`. premultiplied16: four numbers of 0 to 65535. */
  colour?: boolean | 'rgba8' | 'premultiplied' | 'rgb565' | 'premultiplied16'
  /** 255 times the light that the scene takes. */
  coverage?: boolean
  /** Of the Gaussian at which half of the light is taken. */
  depth?: boolean
  /** Of all that contribute, weighted by that. */
  meanDepth?: boolean
  ids?: boolean
  /** Read: depths of what is drawn already; a Gaussian that is farther adds nothing there. */
  occluder?: Uint32Array
  /** Read: RGBA8, in place of the background. */
  backdrop?: Uint8ClampedArray | Uint8Array
}

/** Rows from the top, of what was asked for. Depths are along the camera's z axis, units times 2 ** depthBits: what is
 *  farther has 2 ** 32 - 2, and 2 ** 32 - 1 is none. */
export interface Frame {
  readonly width: number
  readonly height: number
  readonly colour?: Uint8ClampedArray | Uint16Array
  readonly coverage?: Uint8Array
  readonly depth?: Uint32Array
  readonly meanDepth?: Uint32Array
  /** Two a pixel: the object's id and the number of the Gaussian that contributes most; 2 ** 32 - 1 where none does. */
  readonly ids?: Uint32Array
}

export interface TargetOptions extends FrameOptions {
  targets: Targets
  /** 1 to 28; 16. */
  depthBits?: number
}

export interface StereoOptions extends FrameOptions {
  /** Each eye has the very bytes of `render`, in the time of two frames; else colours are found once for both. */
  exact?: boolean
}

export interface StereoTargetOptions extends StereoOptions {
  /** Of both eyes, or of each; of one format. */
  targets: Targets | readonly [Targets, Targets]
  depthBits?: number
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
  render(camera: Camera, options: TargetOptions): Frame
  render(camera?: Camera, options?: FrameOptions): Uint8ClampedArray
  renderStereo(left: Camera, right: Camera, options: StereoTargetOptions): [Frame, Frame]
  renderStereo(left: Camera, right: Camera, options?: StereoOptions): [Uint8ClampedArray, Uint8ClampedArray]
  pick(x: number, y: number, camera?: Camera, options?: FrameOptions): Picked | null
  /** Gives its memory back. */
  free(): void
}

/** Ends threads that no scene needs, and gives their memory back; without it they wait for the next scene. Not while one
    is loaded. */
export function end(): Promise<void>

/** Draws objects in one order by depth: RGBA, four bytes a pixel, rows from the top; with `targets` what they name. */
export function render(objects: readonly Placed[], camera: Camera, options: TargetOptions): Frame
export function render(objects: readonly Placed[], camera?: Camera, options?: FrameOptions): Uint8ClampedArray

/** The same for two eyes of one size, in less time than two pictures. `maxMemory` must hold both whole. */
export function renderStereo(
  objects: readonly Placed[], left: Camera, right: Camera, options: StereoTargetOptions): [Frame, Frame]
export function renderStereo(
  objects: readonly Placed[], left: Camera, right: Camera, options?: StereoOptions,
): [Uint8ClampedArray, Uint8ClampedArray]

/** What a pixel shows: the Gaussian that contributes most. */
export function pick(x: number, y: number, objects: readonly Placed[], camera?: Camera, options?: FrameOptions): Picked | null

export interface ScreenOptions extends FrameOptions {
  /** WebGL 2: in place of the canvas, a framebuffer of this context, and the picture's lower left corner there. */
  into?: { framebuffer?: WebGLFramebuffer | null; x?: number; y?: number }
}

/** A canvas that is drawn on again and again, in the page or in a Worker. It has one kind of context for life. */
export class Screen {
  private constructor()
  /**
   * 'wasm': the picture of `render` is copied to the canvas. 'webgl2': the graphics processor draws the same bytes.
   * 'webgl2-quads': it draws a picture that is not exact. Rejects where there is no WebGL 2. The scenes to be drawn are
   * loaded with the same `simd` and `threads`; without simd128 there is no WebGL.
   */
  static open(
    canvas: HTMLCanvasElement | OffscreenCanvas,
    backend: 'wasm' | 'webgl2' | 'webgl2-quads',
    options?: LoadOptions
  ): Promise<Screen>
  readonly backend: 'wasm' | 'webgl2' | 'webgl2-quads'
  /** Whether WebGL's context was lost, after which `draw` throws. Another Screen on another canvas may go on. */
  readonly lost: boolean
  /** The context of WebGL 2. */
  readonly gl: WebGL2RenderingContext | undefined
  /** As `render`; the canvas takes the size. */
  draw(objects: readonly Placed[], camera?: Camera, options?: ScreenOptions): void
  /** When the device is done with what was drawn. */
  finish(): Promise<void>
  /** What was drawn last: RGBA, rows from the top. */
  pixels(): Uint8ClampedArray
  /** Gives its memory back; the canvas keeps its picture. */
  free(): void
}

/** A .png file of a picture. */
export function png(pixels: Uint8ClampedArray, width: number, height: number): Promise<Uint8Array>
