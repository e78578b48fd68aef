/** True if this browser or Node supports simd128, the vector instructions of WebAssembly. `load` then uses them. */
export const hasSimd: boolean

/** True if this browser or Node also supports relaxed simd128. Rendering is then a quarter faster; the pictures are the
    same. */
export const hasRelaxed: boolean

/** Pixels that ImageData accepts: Uint8ClampedArray<ArrayBuffer> in TypeScript 5.7 and later, Uint8ClampedArray in
    older versions. The memory is not shared. */
export type Pixels = ReturnType<typeof Uint8ClampedArray.of>

/** Bytes that Blob and Response accept. The memory is not shared. */
export type Bytes = ReturnType<typeof Uint8Array.of>

/** Sets the URL of the folder that holds the files of this package (*.wasm, *.js, viewer/). It is needed with bundlers
    that do not copy these files. Call it before anything is loaded. */
export function setAssets(folder: string | URL): void

/** Three numbers: x, y, z, or red, green, blue. */
export type Vector = readonly [number, number, number]

/** Options of `load` and `Screen.open`. `Screen.open` reads only `simd` and `threads`. */
export interface LoadOptions {
  /** How Gaussians are packed; ignored for .fxs files, which are packed already. At degree 3 of the spherical harmonics
      (SH, the colours that depend on the direction of view), a Gaussian takes 63.5 bytes with 'default', 39.6 with
      'compact' and 19.6 with 'small'. 'default' by default. */
  profile?: 'default' | 'compact' | 'small'
  /** The directions of the axes x, y, z of an .spz file: 'rub' is right, up, back; 'rdf' is right, down, front.
      'file', the default, uses the axes that the file states. */
  axes?: 'file' | 'rub' | 'rdf'
  /** The largest number of Gaussians to read; a larger scene is an Error. Ignored for .fxs files. The default is
      1,000,000 plus the size of the file in bytes, at most 2 ** 26. */
  maxGaussians?: number
  /** The largest number of bytes of memory for reading and packing the file. A file that needs more is an Error.
      Ignored for .fxs files. By default, the limit follows from `maxGaussians`. */
  maxMemory?: number
  /** Called from time to time with the progress of the download and of the preparation. */
  progress?: (progress: Progress) => void
  /** Called with a preview: a scene of at most 100,000 of the Gaussians that have arrived, enlarged and without SH.
      Previews come during the download of a .ply, .splat, .ksplat or compressed .ply file if the server states the
      length of the file, and before a large scene is packed. An .fxs file has no previews. The caller owns the preview
      and must call `free` on it. If the function returns a promise, loading waits for it. */
  preview?: (scene: Scene) => void | Promise<void>
  /** Cancels loading: the promise is rejected with the reason of the signal, and all requests are aborted. The signal
      has no effect after loading. */
  signal?: AbortSignal
  /** Time-out in milliseconds: a request fails if the server sends less than 1000 bytes in this time. 30000 by default.
      The time does not run while the download waits for `preview`. */
  silence?: number
  /** False loads the WebAssembly module without simd128; the default is `hasSimd`. All scenes of one picture must be
      loaded with the same `simd` and the same `threads`. */
  simd?: boolean
  /**
   * The number of threads that draw, 1 to 64, the caller's thread included. The default is the number of processors, at
   * most 8. One thread draws if simd128 is missing, or in a page where `crossOriginIsolated` is not true. A server
   * isolates a page by the headers Cross-Origin-Opener-Policy: same-origin and Cross-Origin-Embedder-Policy:
   * require-corp. The pictures do not depend on the number of threads.
   */
  threads?: number
  /**
   * Options for streaming an .fxs file with levels of detail. A scene is streamed if its address is http or https and
   * ends in .fxs, and its server supports range requests. `load` then fetches only the tables of the file and the
   * coarsest parts. `render` draws at once with the parts in memory, and requests the missing parts, the most important
   * first. `changed` tells when to draw again. When no part is missing, the picture is byte for byte the picture of the
   * whole file. False: the whole file is downloaded first.
   */
  paging?: false | Paging
}

/** Options of streamed scenes. */
export interface Paging {
  /** Bytes of memory for the parts (the pool); 512e6 by default, less if memory is short. The tables take 290 bytes
      more for each 256 Gaussians. If the pool is full, the least recently used part is dropped; the coarsest parts
      stay. The `budget` of a picture can be at most half the capacity of the pool. Without a budget, a picture has at
      most 1,000,000 Gaussians; a smaller scene is drawn whole. */
  memory?: number
  /** Capacity of the cache on disk in bytes, for all scenes together; 1e9 by default, 0 for no cache. The cache keeps
      parts for the next visit, by address and version. It needs a browser, a secure page, and a server that sends ETag
      or Last-Modified. */
  cache?: number
  /** The largest number of requests at the same time; 6 by default. */
  requests?: number
  /** Overrides `LoadOptions.silence` for all requests of this scene. */
  silence?: number
  /** Called when parts have arrived, at most every 50 ms. Called once with an Error when requests have failed: the file
      has changed on the server or is damaged, or the server fails repeatedly. The scene can still be drawn. After a
      network error, pictures drawn 5 seconds later or more request their parts again. */
  changed?: (error?: Error) => void
}

/** The progress of `load`. */
export interface Progress {
  /** 'download' while a file is fetched, then 'prepare' while it is read and packed. */
  stage: 'download' | 'prepare'
  /** The completed share of the stage, 0 to 1; undefined if the length of a download is not known. */
  done?: number
  /** The number of downloaded bytes, all files of the scene together; undefined in the stage 'prepare'. */
  bytes?: number
}

/** Opens a scene file. Formats: @FORMATS@.
    `source` is an address (in Node also a path), the bytes of a file, a Blob, or a list of files. A scene file may name
    other files. They are read too if they are in the folder of the scene file or below it; files elsewhere are not
    read. In a list of files, the other files are found by webkitRelativePath or name. Limits: 2 GB for a file, 4 GB for
    all files of a scene. The download stops early if the first bytes are not a scene, or if the file is far longer than
    its header says. A redirection from https to http is refused. If the scene cannot be opened, the promise is rejected
    with an Error that states the reason. */
export function load(
  source: string | URL | ArrayBuffer | ArrayBufferView | Blob | Iterable<File>,
  options?: LoadOptions
): Promise<Scene>

/** A camera given by its position and the point that it looks at. Positions are in scene units. The y axis points down
    by default, see `up`. Without `eye` and `up`, fixsplat chooses an upright view that shows much of the objects, see
    `firstView`; the choice takes about 0.2 seconds, once for the same objects. A single scene with a `start` view,
    drawn without placement and without `fov`, is seen by its start view. */
export interface LookAt {
  /** The position of the camera. If `up` is given and `eye` is not, the camera shows all objects completely. */
  eye?: Vector
  /** The point that the camera looks at. The default is the middle of the box around the objects. */
  look?: Vector
  /** The direction that points up in the picture; [0, -1, 0] by default. */
  up?: Vector
  /** The vertical field of view, 1 to 170 degrees; 50 by default. */
  fov?: number
  /** The depth of the near plane, in scene units. The default is a hundredth of half the diagonal of the box around the
      objects, and at most 0.2. */
  near?: number
  /** The size of the picture in pixels. `FrameOptions.width` and `height` take precedence. */
  width?: number
  height?: number
}

/** A camera given by its intrinsics and its pose, as in a cameras.json file. */
export interface Pinhole {
  /** The rotation from the camera to the world, as three rows of three numbers. Its columns are the axes of the camera
      in the world: x right, y down, z forward. */
  rotation: readonly Vector[]
  /** The position of the camera in the world, in scene units. */
  position: Vector
  /** The horizontal focal length in pixels, for a picture of `width` x `height`. For a picture of another size, the
      focal lengths and the distance of the principal point from the middle are multiplied by the ratio of the
      widths. */
  fx: number
  /** The vertical focal length in pixels; `fx` by default. */
  fy?: number
  /** The principal point in pixels, x and y; the middle of the picture by default. */
  cx?: number
  cy?: number
  /** The depth of the near plane, in scene units; 0.2 by default. */
  near?: number
  /** True for an orthographic camera: parallel rays, and `fx` and `fy` in pixels per scene unit. False by default. */
  orthographic?: boolean
  /** The size in pixels of the picture to which `fx`, `fy`, `cx` and `cy` refer; by default the size of the frame. */
  width?: number
  height?: number
}

export type Camera = LookAt | Pinhole

/** Options of a picture. */
export interface FrameOptions {
  /** The size of the picture in pixels, 1 to 16384 each. The default is the size that the camera states; without one,
      1280 x 720. */
  width?: number
  height?: number
  /** The colour behind the scene as the number 0xrrggbb; black by default. */
  background?: number
  /** True for a transparent picture without a background: colours are premultiplied, alpha is the coverage. False by
      default. */
  alpha?: boolean
  /** The highest degree of SH that is evaluated, 0 to 3; 3 by default. */
  shDegree?: 0 | 1 | 2 | 3
  /** The extent of a Gaussian. 'mahalanobis', the default: it ends at a Mahalanobis distance of 3. 'square': it covers
      all tiles of 16x16 pixels that a square of side 6 sigma about its centre touches, as in Kerbl et al. 2023; sigma
      is the largest standard deviation of the Gaussian in the picture. */
  cutoff?: 'mahalanobis' | 'square'
  /** The largest number of Gaussians to draw, for scenes with levels of detail (`fixsplat convert --levels`). The parts
      with the least detail in the picture are drawn by coarse Gaussians. All objects share the budget. By default all
      Gaussians are drawn; a streamed scene has another default, see `Paging.memory`. Scenes without levels ignore
      it. */
  budget?: number
  /** For scenes with levels of detail: the smallest detail to draw, 1/256 to 16384 pixels. Smaller details are
      drawn by coarse Gaussians. 0 by default: no limit. May be combined with `budget`. */
  detail?: number
  /** For streamed scenes: false draws with the parts in memory and requests no other parts. True by default. */
  fetch?: boolean
  /** The largest number of bytes of working memory. By default, the memory that a whole frame needs. With less memory
      the same picture takes longer; too little memory is an Error. */
  maxMemory?: number
}

/** Statistics of a picture. */
export interface Drawn {
  /** The number of Gaussians that were processed, visible or not. At most the budget, if there is one. Scenes without
      levels of detail, and one part (256 Gaussians) of each other scene, are drawn even beyond the budget. */
  readonly drawn: number
  /** The number of missing parts of the scene; coarser parts are drawn instead. 0: the picture is complete. See
      `LoadOptions.paging`. */
  readonly missing: number
}

/** The pictures that a frame writes. The frame contains each target that is named here; the others cost no time.
    `occluder` and `backdrop` are inputs. An array of the wrong length is an Error. */
export interface Targets {
  /** The colours, in a format. 'rgba8': four bytes a pixel. 'premultiplied': four bytes a pixel, red, green and blue
      times the coverage, and the coverage. 'premultiplied16': the same with four numbers of 0 to 65535 a pixel.
      'rgb565': one number of 16 bits a pixel. True means 'premultiplied' if `alpha` is true, else 'rgba8'. */
  colour?: boolean | 'rgba8' | 'premultiplied' | 'rgb565' | 'premultiplied16'
  /** The coverage: the share of the light that the Gaussians at a pixel absorb, times 255. */
  coverage?: boolean
  /** The median depth: the depth of the Gaussian, from near to far, at which more than half of the light has been
      absorbed. */
  depth?: boolean
  /** The mean depth of the Gaussians at a pixel, weighted by their contributions. */
  meanDepth?: boolean
  /** The object and the Gaussian with the largest contribution to a pixel. */
  ids?: boolean
  /** Input: the depth of other geometry at each pixel, in the units of `Frame`. A Gaussian whose centre is farther is
      hidden at that pixel. */
  occluder?: Uint32Array
  /** Input: a picture to draw instead of the background colour, four bytes a pixel: red, green, blue, and a byte that
      is ignored. It cannot be combined with the formats 'premultiplied' and 'premultiplied16'. */
  backdrop?: Uint8ClampedArray | Uint8Array
}

/** The requested targets, each an array of rows of pixels from the top. Depths are distances along the z axis of the
    camera, in scene units times 2 ** depthBits. They saturate at 2 ** 32 - 2. 2 ** 32 - 1 is a pixel without a
    depth. */
export interface Frame extends Drawn {
  readonly width: number
  readonly height: number
  /** Uint16Array for the formats 'rgb565' and 'premultiplied16', else Uint8ClampedArray. */
  readonly colour?: Pixels | Uint16Array
  readonly coverage?: Uint8Array
  readonly depth?: Uint32Array
  readonly meanDepth?: Uint32Array
  /** Two numbers a pixel, for the Gaussian with the largest contribution: the id of its object, and its index in the
      packed scene. Both are 2 ** 32 - 1 if no Gaussian contributes. */
  readonly ids?: Uint32Array
}

/** Options of a picture with named targets. */
export interface TargetOptions extends FrameOptions {
  targets: Targets
  /** The number of fraction bits of depths, 1 to 28; 16 by default. */
  depthBits?: number
}

/** Options of a stereo picture with named targets. */
export interface StereoTargetOptions extends FrameOptions {
  /** One value for both eyes, or one for each eye. The colours of both eyes must have the same format. */
  targets: Targets | readonly [Targets, Targets]
  /** The number of fraction bits of depths, 1 to 28; 16 by default. */
  depthBits?: number
}

/** A crop box in the coordinates of the scene. It selects Gaussians by their centres. */
export interface Crop {
  /** The smallest x, y and z of the box, in scene units. */
  low: Vector
  /** The largest x, y and z of the box, in scene units. */
  high: Vector
  /** 'inside', the default, keeps the Gaussians inside the box. 'outside' keeps the Gaussians outside. */
  keep?: 'inside' | 'outside'
}

/** An object: a scene placed in the world. A position in the scene becomes translation + scale * rotation * position
    in the world. */
export interface Placed {
  scene: Scene
  /** In world units; [0, 0, 0] by default. */
  translation?: Vector
  /** A quaternion in the order w, x, y, z; [1, 0, 0, 0] by default. */
  rotation?: readonly [number, number, number, number]
  /** 1 by default. */
  scale?: number
  /** A factor for the opacity of all Gaussians, 0 to 1; 1 by default. */
  opacity?: number
  /** Factors for red, green and blue, 0 to 4 each; [1, 1, 1] by default. */
  tint?: Vector
  /** False: the object is not drawn. True by default. */
  visible?: boolean
  /** The id of this object in the target `ids`, 0 to 2 ** 32 - 2. The default is its index among the objects. */
  id?: number
  /** At most 8 boxes. A Gaussian is drawn if it is in at least one 'inside' box and in no 'outside' box. Without
      'inside' boxes, only the 'outside' boxes count. */
  crops?: readonly Crop[]
}

/** The Gaussian with the largest contribution to a pixel. */
export interface Picked {
  /** The index of the Gaussian's object in the list of objects. */
  object: number
  /** Its index in the packed scene. */
  gaussian: number
  /** The distance of the Gaussian's centre along the z axis of the camera, in world units. */
  depth: number
  /** The point at this depth on the ray through the pixel, in world units. */
  position: [number, number, number]
}

/** A packed scene in the memory of a WebAssembly module, made by `load`. After `free`, drawing it throws an Error. */
export class Scene {
  private constructor()
  /** The name of the scene's file; 'scene' for bytes without a name. */
  readonly name: string
  /** The number of Gaussians. */
  readonly count: number
  /** True if the scene has levels of detail, for `budget` and `detail`. */
  readonly levels: boolean
  /** True if the scene is streamed; see `LoadOptions.paging`. */
  readonly paged: boolean
  /** For streamed scenes: the error that stopped the requests; else null. */
  readonly failure: Error | null
  /** The SH degree, 0 to 3. */
  readonly shDegree: number
  /** How the Gaussians are packed; see `LoadOptions.profile`. */
  readonly profile: 'default' | 'compact' | 'small'
  /** The smallest x, y, z (`low`) and the largest x, y, z (`high`) of the visible part of the scene, in scene units. */
  readonly low: number[]
  readonly high: number[]
  /** The size of the packed scene in bytes. */
  readonly bytes: number
  /** The view that fixsplat chooses for the scene. `up`: the up direction. `low` and `high`: the box to look at, which
      is the box of the scene, or of its core if the surroundings extend far beyond. `from`: the direction from the
      middle of the box to the camera. `part`: the distance of the camera as a share, 0.5 to 1, of the distance that
      shows the whole box; 0 for a view from within the scene: the camera is in the middle of the box and looks against
      `from`. `known`: true if the .fxs file stores the up direction, as files of `fixsplat fit` do; false if it was
      estimated from small pictures. */
  readonly first: { up: number[]; from: number[]; part: number; low: number[]; high: number[]; known: boolean }
  /** The start view that is stored in the .fxs file, as a camera for a picture of 2 x 2 pixels; null if the file has
      none. `render` without a camera uses it. */
  readonly start: Pinhole | null
  /** The number of threads that draw the scene now. Threads that are still starting are not counted, and pictures do
      not wait for these threads. */
  readonly threads: number
  /** A copy of the packed scene: the bytes of an .fxs file. Throws an Error for a streamed scene. */
  readonly packed: Bytes
  /** Draws this scene alone; see the function `render`. */
  render(camera: Camera, options: TargetOptions): Frame
  render(camera?: Camera, options?: FrameOptions): Pixels
  /** Draws this scene alone for two eyes; see the function `renderStereo`. */
  renderStereo(left: Camera, right: Camera, options: StereoTargetOptions): [Frame, Frame]
  renderStereo(left: Camera, right: Camera, options?: FrameOptions): [Pixels, Pixels]
  /** Finds the Gaussian of this scene at a pixel; see the function `pick`. */
  pick(x: number, y: number, camera?: Camera, options?: FrameOptions): Picked | null
  /** Prefetches the parts of this scene for a camera; see the function `foresee`. */
  foresee(camera?: Camera, options?: FrameOptions): number
  /** Waits until all parts that a picture of this scene needs have arrived. Rejected with an Error if requests fail, or
      if the pool (`Paging.memory`) is too small for the picture. */
  complete(camera?: Camera, options?: FrameOptions): Promise<void>
  /** Frees the memory of the scene. Further calls do nothing. */
  free(): void
}

/** Ends the threads that no scene and no Screen uses, and frees their memory. Without this call, the threads wait for
    the next scene. Do not call it while a scene is being loaded. */
export function end(): Promise<void>

/** Draws objects into one picture. The Gaussians of all objects are sorted together by depth. Returns the pixels from
    the top row down, four bytes each: red, green, blue, alpha. With `targets`, it returns a Frame of the named targets
    instead. Throws an Error that states the reason if an argument is not valid or memory is too small. */
export function render(objects: readonly Placed[], camera: Camera, options: TargetOptions): Frame
export function render(objects: readonly Placed[], camera?: Camera, options?: FrameOptions): Pixels

/** Draws objects for two eyes. Each picture is byte for byte what `render` draws with its camera; both have the same
    size. Returns the left and the right picture. */
export function renderStereo(
  objects: readonly Placed[], left: Camera, right: Camera, options: StereoTargetOptions): [Frame, Frame]
export function renderStereo(
  objects: readonly Placed[], left: Camera, right: Camera, options?: FrameOptions,
): [Pixels, Pixels]

/** Chooses a view of the objects, in the form of `Scene.first`. Takes about 0.2 seconds, once for the same objects. */
export function firstView(objects: readonly Placed[]): Scene['first']

/** Prefetches parts of streamed scenes (`LoadOptions.paging`): requests the missing parts of a picture from this
    camera, after the missing parts of the last picture. Draws nothing and returns at once. Returns the number of
    missing parts. */
export function foresee(objects: readonly Placed[], camera?: Camera, options?: FrameOptions): number

/** Finds the Gaussian with the largest contribution to the pixel in column x and row y, counted from 0 at the top left.
    Returns null if no Gaussian contributes. */
export function pick(x: number, y: number, objects: readonly Placed[], camera?: Camera, options?: FrameOptions): Picked | null

/** Draws into a texture of the device, or into a part of the canvas, with the back end 'webgpu'. The textures are read
    and written until `finish` is fulfilled. */
export interface IntoTexture {
  /** A texture with the usage RENDER_ATTACHMENT and the format rgba8unorm, bgra8unorm, rgba16float or rgba32float.
      Colours are written in sRGB. Without a texture, the picture is drawn into a part of the Screen's canvas; the
      canvas keeps its size and its other pixels. */
  texture?: GPUTexture
  /** The position of the picture in the texture or canvas: the pixel for its top left corner, counted from the top
      left; 0 and 0 by default. */
  x?: number
  y?: number
  /** A depth buffer of other geometry at the same pixels, in a depth format and with the usage TEXTURE_BINDING. A
      Gaussian whose centre is farther than the depth at a pixel is hidden there. `planes`: the distances from the
      camera, in scene units, of the depths 0 and 1. Either may be the distance of the far plane, which hides nothing
      and may be Infinity. `linear`: true if depths between 0 and 1 are linear in distance, as with an orthographic
      camera; false, the default, for a perspective camera. */
  depth?: { texture: GPUTexture; planes: readonly [number, number]; linear?: boolean }
  /** With `alpha`: true blends the picture over the contents of the texture. False, the default, overwrites them. */
  over?: boolean
}

/** Buffers of the device for the targets of a Frame, with the back end 'webgpu'. Targets are 32-bit numbers in rows of
    pixels from the top; `colour` is four bytes a pixel: red, green, blue, alpha. A buffer needs the usage COPY_DST and
    4 bytes a pixel, 8 for `ids`. It is written when the picture is complete, at the latest when `finish` is
    fulfilled. */
export interface IntoBuffers {
  colour?: GPUBuffer
  depth?: GPUBuffer
  meanDepth?: GPUBuffer
  ids?: GPUBuffer
}

/** Options of `Screen.draw`. */
export interface ScreenOptions extends FrameOptions {
  /** For the back end 'webgpu'. A Screen without a canvas may draw `targets` alone. */
  targets?: IntoBuffers
  /** The number of fraction bits of depths in `targets`, 1 to 28; 16 by default. */
  depthBits?: number
  /** Draws into another target instead of the whole canvas. 'webgpu': see IntoTexture. 'webgl2': `framebuffer` is a
      framebuffer of the Screen's context; null, the default, is the canvas, which keeps its size. `x` and `y` are the
      pixel of the framebuffer for the lower left corner of the picture, 0 and 0 by default. `depth` is the depth buffer
      of a perspective camera: a texture with the filter NEAREST, aligned with the picture at the lower left corner, and
      its `planes` as in IntoTexture. */
  into?:
    | {
        framebuffer?: WebGLFramebuffer | null
        x?: number
        y?: number
        depth?: { texture: WebGLTexture; planes: readonly [number, number] }
      }
    | IntoTexture
  /** A picture to draw instead of the background colour, as `Targets.backdrop`. Not possible with `alpha`. */
  backdrop?: Uint8ClampedArray | Uint8Array
}

type Backend = 'wasm' | 'webgl2' | 'webgpu'

/** Draws any number of pictures on a canvas, in the page or in a Worker. A canvas keeps the kind of its context, so a
    Screen with another kind of context needs another canvas. After `free`, using the Screen throws an Error. */
export class Screen {
  private constructor()
  /**
   * Opens a Screen with a back end. All draw the same bytes:
   * - 'wasm' copies the picture of `render` to the canvas.
   * - 'webgpu' renders on the GPU. A scene is copied to the GPU once. It cannot draw streamed scenes.
   * - 'webgl2' prepares the picture on the processor and draws it on the GPU.
   *
   * The promise is rejected if the canvas already has a context of another kind. For all back ends except 'wasm', it is
   * also rejected without simd128 or without WebGPU or WebGL 2. The scenes to be drawn must be loaded with the same
   * `simd` and `threads`. For 'webgpu' the canvas may be null, and `device` may be a device of the caller; by default
   * all Screens share one device.
   */
  static open(
    canvas: HTMLCanvasElement | OffscreenCanvas | null,
    backend: 'webgpu',
    options?: LoadOptions & { device?: GPUDevice }
  ): Promise<Screen & { readonly device: GPUDevice }>
  static open(
    canvas: HTMLCanvasElement | OffscreenCanvas | null,
    backend: Backend,
    options?: LoadOptions & { device?: GPUDevice }
  ): Promise<Screen>
  /** The back end that was given to `open`. */
  readonly backend: Backend
  /** True if the WebGL context or the WebGPU device was lost. `draw` then throws an Error. Open a new Screen to
      continue; for WebGL it needs another canvas. */
  readonly lost: boolean
  /** The WebGL 2 context of the canvas; undefined with other back ends. */
  readonly gl: WebGL2RenderingContext | undefined
  /** The device of the back end 'webgpu'; undefined with other back ends. */
  readonly device: GPUDevice | undefined
  /** Draws objects as `render` does, and sets the canvas to the size of the picture. With the back end 'webgpu' the GPU
      completes the picture later, at the latest when `finish` is fulfilled; the canvas shows the previous picture until
      then. If `draw` is called several times before that, only the last picture is shown. */
  draw(objects: readonly Placed[], camera?: Camera, options?: ScreenOptions): Drawn
  /** Fulfilled when the GPU has completed all pictures. With the back end 'webgpu' it is rejected with a one-line Error
      if the last picture failed; a failed picture is not shown, and `draw` may be called again. */
  finish(): Promise<void>
  /** The pixels of the last picture from the top row down, four bytes each: red, green, blue, alpha. With the back end
      'webgpu' a promise of the pixels. */
  pixels(): Pixels | Promise<Pixels>
  /** Frees the memory of the Screen. The canvas keeps its picture. Further calls do nothing. */
  free(): void
}

/** Encodes the pixels of a picture as a .png file: rows from the top, four bytes a pixel: red, green, blue, alpha. */
export function png(pixels: Uint8ClampedArray, width: number, height: number): Promise<Bytes>
