/** True if the platform supports simd128, the vector instructions of WebAssembly. `load` then uses simd128. */
export const hasSimd: boolean

/** True if the platform also supports relaxed simd128, which renders faster. */
export const hasRelaxed: boolean

/** The type of an array of pixels that ImageData accepts. */
export type Pixels = ReturnType<typeof Uint8ClampedArray.of>

/** The type of an array of bytes that Blob and Response accept. */
export type Bytes = ReturnType<typeof Uint8Array.of>

/** Sets the URL of the folder with the package's .wasm and .js files. Call this function first if a bundler
    does not copy these files. */
export function setAssets(folder: string | URL): void

/** A vector of three numbers: x, y, z of a point, or red, green, blue of a colour. */
export type Vector = readonly [number, number, number]

/** Options of `load` and `Screen.open`. `Screen.open` reads only `simd` and `threads`. */
export interface LoadOptions {
  /** The packing profile; 'default' by default. With spherical harmonics (SH) of degree 3, a Gaussian takes 63.5
      bytes as 'default', 39.6 as 'compact' and 19.6 as 'small'. Ignored for .fxs files. */
  profile?: 'default' | 'compact' | 'small'
  /** The axes x, y, z of an .spz file: 'rub' is right, up, back; 'rdf' is right, down, front. 'file', the default,
      uses the axes that the file states. */
  axes?: 'file' | 'rub' | 'rdf'
  /** The largest number of Gaussians to read; a larger scene is an Error. The default is 1,000,000 plus the size of
      the file in bytes, at most 2 ** 26. Ignored for .fxs files. */
  maxGaussians?: number
  /** The largest number of bytes of memory for reading and packing a file. The default follows from `maxGaussians`.
      Ignored for .fxs files. */
  maxMemory?: number
  /** Receives the progress of loading: of the download, and of the preparation (reading and packing). */
  progress?: (progress: Progress) => void
  /** Receives a preview: a scene of at most 100,000 of the Gaussians that have arrived, enlarged and without SH. The
      caller must call `free` on each preview. If the function returns a promise, loading waits for it. An .fxs file
      has no previews. */
  preview?: (scene: Scene) => void | Promise<void>
  /** A signal that cancels loading. The promise of `load` is then rejected with the reason of the signal. */
  signal?: AbortSignal
  /** The time-out of a request in milliseconds; 30000 by default. A request fails if fewer than 1000 bytes arrive in
      this time. */
  silence?: number
  /** False loads the WebAssembly module without simd128; the default is `hasSimd`. All scenes of one picture need
      the same `simd` and the same `threads`. */
  simd?: boolean
  /** The number of drawing threads, 1 to 64, with the caller's thread. The default is the number of processors, at
      most 8. A page needs `crossOriginIsolated` for more than one thread. A server isolates a page by the headers
      Cross-Origin-Opener-Policy: same-origin and Cross-Origin-Embedder-Policy: require-corp. */
  threads?: number
  /** Options for streaming: loading the parts of an .fxs file with levels of detail, or of a moving scene, when a
      picture needs them. False downloads the whole file first. A scene is streamed if its address is http or https and ends in .fxs, and the
      server supports range requests. `render` draws the loaded parts at once and requests missing parts. `changed`
      tells when to draw again. */
  paging?: false | Paging
}

export interface Paging {
  /** The memory in bytes for the parts of the scene, called the pool; 512e6 by default. A full pool drops the least
      recently used part, except the coarsest parts. `budget` can be at most half the capacity of the pool. The
      default budget is 1,000,000 Gaussians; a smaller scene is drawn whole. A moving scene has no budget, and the pool
      must hold all parts that are seen at one time. */
  memory?: number
  /** The capacity in bytes of the cache on disk, for all scenes together; 1e9 by default, 0: no cache. The cache
      needs a browser, a secure page, and a server that sends ETag or Last-Modified. */
  cache?: number
  /** The largest number of simultaneous requests; 6 by default. */
  requests?: number
  /** The time-out in milliseconds of a request for this scene, instead of `LoadOptions.silence`. */
  silence?: number
  /** The callback for arrived parts, called at most every 50 ms. The callback receives an Error once if the file is
      damaged, has changed, or the server fails repeatedly. The scene can still be drawn. */
  changed?: (error?: Error) => void
}

export interface Progress {
  /** The stage of loading: 'download' while a file is fetched, then 'prepare' while the file is read and packed. */
  stage: 'download' | 'prepare'
  /** The completed share of the stage, 0 to 1; undefined if the length of a download is not known. */
  done?: number
  /** The number of downloaded bytes of all files of the scene; undefined in the stage 'prepare'. */
  bytes?: number
}

/** Opens a scene file. Formats: @FORMATS@.
    `source` is an address, the bytes of a file, a Blob, or a list of files; in Node also a path. Other files that
    the scene file names must lie in its folder or below. In a list of files, other files are found by
    webkitRelativePath or name. Limits: 2 GB for one file, 4 GB for all files of a scene. If the scene cannot be
    opened, the promise is rejected with an Error that states the reason. */
export function load(
  source: string | URL | ArrayBuffer | ArrayBufferView | Blob | Iterable<File>,
  options?: LoadOptions
): Promise<Scene>

/** A camera given by its position and target, in scene units. The y axis points down by default; see `up`. Without
    `eye` and `up`, fixsplat chooses an upright view; see `firstView`. A scene with a start view (`Scene.start`) is then
    shown in its start view. This holds if the scene is the only object and has no placement, and `fov` is not given. */
export interface LookAt {
  /** The position of the camera in scene units. If `up` is given without `eye`, the camera shows all objects
      completely. */
  eye?: Vector
  /** The target of the camera. The default is the middle of the box around the objects. */
  look?: Vector
  /** The direction that points up in the picture; [0, -1, 0] by default. */
  up?: Vector
  /** The vertical field of view, 1 to 170 degrees; 50 by default. */
  fov?: number
  /** The depth of the near plane in scene units. The default depends on the size of the objects, and is at most 0.2. */
  near?: number
  /** The width and height of the picture in pixels. `FrameOptions.width` and `height` take precedence. */
  width?: number
  height?: number
}

/** A camera given by its intrinsics and its pose, as in a cameras.json file. */
export interface Pinhole {
  /** The rotation from the camera to the world, as three rows of three numbers. The columns are the camera's axes in
      the world: x right, y down, z forward. */
  rotation: readonly Vector[]
  /** The position of the camera in the world, in scene units. */
  position: Vector
  /** The horizontal focal length in pixels, for a picture of `width` x `height`. For a picture of another size,
      focal lengths are multiplied by the ratio of the widths. */
  fx: number
  /** The vertical focal length in pixels; `fx` by default. */
  fy?: number
  /** The principal point in pixels, x and y; the middle of the picture by default. */
  cx?: number
  cy?: number
  /** The depth of the near plane, in scene units; 0.2 by default. */
  near?: number
  /** True for an orthographic camera, with parallel rays; false by default. `fx` and `fy` are then in pixels per
      scene unit. */
  orthographic?: boolean
  /** The size in pixels of the picture that `fx`, `fy`, `cx` and `cy` belong to; the size of the frame by default. */
  width?: number
  height?: number
}

export type Camera = LookAt | Pinhole

export interface FrameOptions {
  /** The size of the picture in pixels, 1 to 16384 each. The default is the size that the camera states, else 1280 x
      720. */
  width?: number
  height?: number
  /** The colour behind the scene as the number 0xrrggbb; black by default. */
  background?: number
  /** True for a picture without a background: colours are premultiplied and alpha is the coverage. False by default. */
  alpha?: boolean
  /** The highest degree of SH that is evaluated, 0 to 3; 3 by default. */
  shDegree?: 0 | 1 | 2 | 3
  /** The extent of a drawn Gaussian. 'mahalanobis', the default, ends a Gaussian at a Mahalanobis distance of 3.
      'square' covers each tile of 16x16 pixels that a square of side 6 sigma touches (Kerbl et al. 2023). Sigma is
      the largest standard deviation of the Gaussian in the picture. */
  cutoff?: 'mahalanobis' | 'square'
  /** The largest number of Gaussians in a picture, for scenes with levels of detail (`fixsplat convert --levels`).
      All objects share the budget. The default is no limit, except for streamed scenes; see `Paging.memory`. Scenes
      without levels ignore the budget. */
  budget?: number
  /** The smallest detail to draw, 1/256 to 16384 pixels, for scenes with levels of detail. Coarse Gaussians replace
      smaller details. The default is 0: no limit. */
  detail?: number
  /** The moment of moving scenes in seconds, within 1,000,000; 0 by default. A scene that loops takes the time modulo
      its duration, another scene stops at its first and last moment. */
  time?: number
  /** For `render`: the first row and the number of rows to render. The default is the whole picture. A picture that is
      too large for the memory can be rendered in such parts, which have the same bytes. */
  rows?: readonly [number, number]
  /** False draws a streamed scene with its loaded parts and requests no other parts. True by default. */
  fetch?: boolean
  /** The largest number of bytes of working memory. The default is the memory of a whole frame. With less memory, a
      picture takes longer; too little memory is an Error. */
  maxMemory?: number
}

export interface Drawn {
  /** The number of Gaussians that were processed for the picture, visible or not. `FrameOptions.budget` does not limit
      this number for scenes without levels of detail. */
  readonly drawn: number
  /** The number of parts of streamed scenes (`LoadOptions.paging`) that have not arrived, or with 'webgpu' are not in
      the GPU's pool. The picture has coarser parts in their place. 0: the picture is complete. */
  readonly missing: number
}

/** The targets of a frame: the pictures that drawing writes, such as colours and depths. `occluder` and `backdrop` are
    inputs. An array of the wrong length is an Error. */
export interface Targets {
  /** The format of the colours. 'rgba8': four bytes a pixel. 'premultiplied': four bytes a pixel, red, green and
      blue times the coverage, then the coverage. 'premultiplied16': premultiplied colours and coverage as four
      numbers of 0 to 65535. 'rgb565': one number of 16 bits a pixel. True means 'premultiplied' if `alpha` is true,
      else 'rgba8'. */
  colour?: boolean | 'rgba8' | 'premultiplied' | 'rgb565' | 'premultiplied16'
  /** The coverage times 255. The coverage is the share of the light that the Gaussians at a pixel absorb. */
  coverage?: boolean
  /** The median depth at a pixel: the depth of the first Gaussian, from near to far, with which more than half of the
      light is absorbed. */
  depth?: boolean
  /** The mean depth of the Gaussians at a pixel, weighted by their contributions. */
  meanDepth?: boolean
  /** For each pixel, the object and the Gaussian with the largest contribution. */
  ids?: boolean
  /** Input: the depth of other geometry at each pixel, in the units of `Frame`. A Gaussian is hidden at a pixel if
      its centre is farther than this depth. */
  occluder?: Uint32Array
  /** Input: a picture to draw instead of the background colour. Each pixel has four bytes: red, green, blue, and an
      ignored byte. Premultiplied formats do not allow a backdrop. */
  backdrop?: Uint8ClampedArray | Uint8Array
}

/** The requested targets as arrays of rows of pixels, from the top. Depths are distances along the z axis of the
    camera, in scene units times 2 ** depthBits. Depths saturate at 2 ** 32 - 2. A pixel without a depth has 2 ** 32
    - 1. */
export interface Frame extends Drawn {
  readonly width: number
  readonly height: number
  /** The colours: a Uint16Array for the formats 'rgb565' and 'premultiplied16', else a Uint8ClampedArray. */
  readonly colour?: Pixels | Uint16Array
  readonly coverage?: Uint8Array
  readonly depth?: Uint32Array
  readonly meanDepth?: Uint32Array
  /** Two numbers a pixel for the Gaussian with the largest contribution: the id of its object, and its index in the
      packed scene. Both numbers are 2 ** 32 - 1 if no Gaussian contributes. */
  readonly ids?: Uint32Array
}

export interface TargetOptions extends FrameOptions {
  targets: Targets
  /** The number of fraction bits of depths, which are fixed-point numbers: 1 to 28; 16 by default. */
  depthBits?: number
}

export interface StereoTargetOptions extends FrameOptions {
  /** The targets of both eyes, or a pair with the targets of each eye. The colours of both eyes must have the same
      format. */
  targets: Targets | readonly [Targets, Targets]
  /** The number of fraction bits of depths, which are fixed-point numbers: 1 to 28; 16 by default. */
  depthBits?: number
}

/** A crop box in scene coordinates, which selects Gaussians by their centres. */
export interface Crop {
  /** The smallest x, y and z of the box, in scene units. */
  low: Vector
  /** The largest x, y and z of the box, in scene units. */
  high: Vector
  /** The Gaussians to keep: 'inside', the default, keeps the Gaussians inside the box, 'outside' the Gaussians
      outside. */
  keep?: 'inside' | 'outside'
}

/** An object: a scene placed in the world. The placement moves a position p of the scene to translation + scale *
    rotation * p. */
export interface Placed {
  scene: Scene
  /** The translation of the object in world units; [0, 0, 0] by default. */
  translation?: Vector
  /** The rotation of the object as a quaternion w, x, y, z; [1, 0, 0, 0] by default. */
  rotation?: readonly [number, number, number, number]
  /** The scale of the object in all directions; 1 by default. */
  scale?: number
  /** A factor for the opacity of all Gaussians, 0 to 1; 1 by default. */
  opacity?: number
  /** Factors for red, green and blue, 0 to 4 each; [1, 1, 1] by default. */
  tint?: Vector
  /** False hides the object. True by default. */
  visible?: boolean
  /** The id of the object in the target `ids`, 0 to 2 ** 32 - 2. The default is the index of the object in the list
      of objects. */
  id?: number
  /** At most 8 crop boxes. A Gaussian is drawn if it is in no 'outside' box and in at least one 'inside' box.
      Without 'inside' boxes, only the 'outside' boxes count. */
  crops?: readonly Crop[]
  /** Seconds that are added to the moment of the frame (`FrameOptions.time`) for a moving scene; 0 by default. */
  time?: number
}

/** The Gaussian with the largest contribution to a pixel, found by `pick`. */
export interface Picked {
  /** The index of the Gaussian's object in the list of objects. */
  object: number
  /** The index of the Gaussian in the packed scene. */
  gaussian: number
  /** The distance of the Gaussian's centre along the z axis of the camera, in world units. */
  depth: number
  /** The point on the ray through the pixel at the depth `depth`, in world units. */
  position: [number, number, number]
}

/** The sound in the file of a moving scene. It begins at time 0 of the scene. */
export type Sound =
  | { type: string; bytes: Uint8Array; volume: number; failure?: undefined }
  /** The sound cannot be read: `failure` says why. */
  | { failure: string; type?: undefined; bytes?: undefined; volume?: undefined }

/** A packed scene in the memory of a WebAssembly module, made by `load`. After `free`, drawing it throws an Error. */
export class Scene {
  private constructor()
  /** The name of the scene's file; 'scene' for bytes without a name. */
  readonly name: string
  readonly count: number
  /** True if the scene has levels of detail, which `budget` and `detail` need. */
  readonly levels: boolean
  /** True if the scene is streamed; see `LoadOptions.paging`. */
  readonly paged: boolean
  /** The error that stopped the requests of a streamed scene; null without an error. */
  readonly failure: Error | null
  /** The duration of a moving scene in seconds; 0: the scene is still. */
  readonly duration: number
  /** The frames a second of a moving scene's source; 0: the motion is continuous. */
  readonly rate: number
  /** True if a moving scene starts again after its duration. */
  readonly loops: boolean
  /** The sound in the file of a moving scene: its media type, the bytes of an audio file, and the volume, 0 to 1. Null
      without a sound; an .fxs has none. */
  readonly sound: Sound | null
  /** The degree of the spherical harmonics, 0 to 3. */
  readonly shDegree: number
  /** The profile by which the scene was packed; see `LoadOptions.profile`. */
  readonly profile: 'default' | 'compact' | 'small'
  /** The smallest (`low`) and the largest (`high`) x, y, z of the visible part of the scene, in scene units. */
  readonly low: number[]
  readonly high: number[]
  /** The size of the packed scene in bytes. */
  readonly bytes: number
  /** The view that fixsplat chooses for the scene. `up` is the up direction. `low` and `high` are the corners of the
      viewed box, the box of the whole scene or of its core. `from` is the direction from the middle of the box to the
      camera. `part` is the distance of the camera as a share, 0.5 to 1, of the distance that shows the whole box. With
      `part` 0, the camera is in the middle of the box and looks against `from`. `known` is true if the .fxs file stores
      the up direction. */
  readonly first: { up: number[]; from: number[]; part: number; low: number[]; high: number[]; known: boolean }
  /** The start view that the .fxs file stores; null if the file stores none. It is a camera with the intrinsics of a
      picture of 2 x 2 pixels. `render` without a camera uses the start view. `reach` is the tangent of the angle that
      the scene reaches to the left or right of the view. A picture higher than wide shows this angle too. `reach`
      is 0 in a room. */
  readonly start: (Pinhole & { readonly reach: number }) | null
  /** The number of started threads that draw the scene. */
  readonly threads: number
  /** A copy of the packed scene: the bytes of an .fxs file. A streamed scene throws an Error. */
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
  /** Prefetches the parts of a streamed moving scene that are seen between two times in seconds, the earliest first,
      after the missing parts of the last picture. At most half of the pool is for them. Does not wait for the parts,
      and returns the number of missing parts. */
  prefetch(from: number, to: number): number
  /** Waits until all parts of a picture of this scene have arrived. The promise is rejected if requests fail, or if
      the pool (`Paging.memory`) is too small. */
  complete(camera?: Camera, options?: FrameOptions): Promise<void>
  /** Frees the memory of the scene. Further calls do nothing. */
  free(): void
}

/** Ends the threads that no scene and no Screen uses, and frees their memory. Do not call this function while a
    scene is loading. */
export function end(): Promise<void>

/** Draws objects into one picture, with all Gaussians sorted together by depth. Returns the pixels from the top row
    down, four bytes each: red, green, blue, alpha. With `targets`, returns a Frame of the named targets instead. */
export function render(objects: readonly Placed[], camera: Camera, options: TargetOptions): Frame
export function render(objects: readonly Placed[], camera?: Camera, options?: FrameOptions): Pixels

/** Draws objects for two eyes and returns the left and the right picture, which have the same size. Each picture has
    the same bytes as `render` with its camera. */
export function renderStereo(
  objects: readonly Placed[], left: Camera, right: Camera, options: StereoTargetOptions): [Frame, Frame]
export function renderStereo(
  objects: readonly Placed[], left: Camera, right: Camera, options?: FrameOptions,
): [Pixels, Pixels]

/** Chooses a view of the objects. Returns its up direction, camera direction and box in the form of `Scene.first`. The
    choice takes about 0.2 seconds and is cached. */
export function firstView(objects: readonly Placed[]): Scene['first']

/** Prefetches parts of streamed scenes (`LoadOptions.paging`) for a camera, without drawing. Missing parts of the last
    picture are requested first. Does not wait for the parts, and returns the number of missing parts. */
export function foresee(objects: readonly Placed[], camera?: Camera, options?: FrameOptions): number

/** Finds the Gaussian with the largest contribution to the pixel in column x and row y, counted from 0 at the top left.
    Returns null if no Gaussian contributes. */
export function pick(x: number, y: number, objects: readonly Placed[], camera?: Camera, options?: FrameOptions): Picked | null

/** Options for drawing with the back end 'webgpu' into a texture, or into a part of the canvas. The GPU reads and
    writes the textures until `finish` is fulfilled. */
export interface IntoTexture {
  /** A texture with the usage RENDER_ATTACHMENT and the format rgba8unorm, bgra8unorm, rgba16float or rgba32float.
      Colours are written in sRGB. Without a texture, the picture covers a part of the Screen's canvas, which keeps
      its size and its other pixels. */
  texture?: GPUTexture
  /** The position of the picture's top left pixel in the texture or canvas, counted from the top left; 0 and 0 by
      default. */
  x?: number
  y?: number
  /** The layer of an array texture; 0 by default. */
  layer?: number
  /** A depth buffer of other geometry at the same pixels, in a depth format and with the usage TEXTURE_BINDING. A
      Gaussian is hidden at a pixel if its centre is farther than the depth there. `planes` are the distances from
      the camera of the depths 0 and 1, in scene units. Either distance may be Infinity. `linear` is true if depths
      are linear in distance, as with an orthographic camera. */
  depth?: { texture: GPUTexture; planes: readonly [number, number]; linear?: boolean }
  /** The way to write a picture with transparency (`FrameOptions.alpha`). True blends the picture over the texture;
      false, the default, overwrites the texture. */
  over?: boolean
}

/** Buffers of the device for the targets of a Frame, with the back end 'webgpu'. A target has 32-bit numbers in rows
    of pixels from the top. `colour` has four bytes a pixel: red, green, blue, alpha. A buffer needs the usage
    COPY_DST and 4 bytes a pixel, or 8 for `ids`. The buffers are complete when `finish` is fulfilled. */
export interface IntoBuffers {
  colour?: GPUBuffer
  depth?: GPUBuffer
  meanDepth?: GPUBuffer
  ids?: GPUBuffer
}

/** Options of `Screen.draw`. */
export interface ScreenOptions extends FrameOptions {
  /** Buffers for targets, with the back end 'webgpu'. A Screen without a canvas may draw into these buffers alone. */
  targets?: IntoBuffers | readonly [IntoBuffers, IntoBuffers]
  /** The number of fraction bits of the fixed-point depths in `targets`, 1 to 28; 16 by default. */
  depthBits?: number
  /** Draws into another target instead of the whole canvas. For 'webgpu', see IntoTexture. For 'webgl2',
      `framebuffer` belongs to the Screen's context; null, the default, is the canvas. `x` and `y` are the lower left
      pixel of the picture in the framebuffer, 0 and 0 by default. `depth` is a perspective depth buffer: a texture
      with the filter NEAREST, aligned with the picture at the lower left corner. */
  into?:
    | {
        framebuffer?: WebGLFramebuffer | null
        x?: number
        y?: number
        depth?: { texture: WebGLTexture; planes: readonly [number, number] }
      }
    | IntoTexture
    | readonly [IntoTexture, IntoTexture]
  /** A picture to draw instead of the background colour, as `Targets.backdrop`. A backdrop with `FrameOptions.alpha` is
      an Error. */
  backdrop?: Uint8ClampedArray | Uint8Array
}

/** A shape that selects the Gaussians with centres in it, or the Gaussians of an object. */
export interface EditShape {
  shape: 'box' | 'sphere' | 'lasso' | 'brush' | 'object'
  /** Box: smallest x, y, z and largest. Sphere: middle and radius. */
  numbers?: number[]
  /** Whole pixels. Lasso: x, y of each corner. Brush: x, y and radius of each disc. Object: x, y, right, bottom of a
      box around the object, or of a pixel of it, then 1, or 0 if it is something else. Joins those before of the same
      camera. */
  points?: number[]
  /** Lasso, brush: leaves out Gaussians behind the surface that the picture shows. */
  front?: boolean
  /** Takes the Gaussians out of the selection. */
  subtract?: boolean
}

/** Numbers of Gaussians that are left and that are selected, and of edits that are done and all. */
export interface EditFacts {
  left: number
  chosen: number
  done: number
  last: number
}

/** Selects and deletes Gaussians of a scene. Call `forget` of each Screen with 'webgpu' after `act` and `go`. */
export interface Editor {
  readonly scene: Scene
  readonly facts: EditFacts
  /** The edits that are done, as the content of a file for `fixsplat convert --edits`. */
  readonly edits: object
  /** Adds the Gaussians in a shape to the selection; the camera and the size are for a lasso, a brush or
      an object. */
  select(shape: EditShape, camera?: Camera, options?: FrameOptions): EditFacts
  clear(): EditFacts
  /** Deletes the selected Gaussians, or with 'keep' all others. */
  act(act: 'delete' | 'keep'): EditFacts
  /** Takes edits back or does them again, until the first `done` edits are done. */
  go(done: number): EditFacts
  /** Returns a picture with dots at the centres of the selected Gaussians. */
  marks(camera: Camera, options: FrameOptions): { pixels: Uint8ClampedArray; width: number; height: number }
  /** Returns the edited scene as the bytes of an .fxs file without levels of detail. */
  write(): Uint8Array
  free(): void
}

/** Experimental: begins to edit a scene that is wholly in memory. The scene loses its levels of detail. */
export function edit(scene: Scene): Promise<Editor>

type Backend = 'wasm' | 'webgl2' | 'webgpu'

/** A Screen draws any number of pictures on a canvas, in the page or in a Worker. A canvas keeps the kind of its
    context, so another back end may need another canvas. A freed Screen throws an Error. */
export class Screen {
  private constructor()
  /** Opens a Screen with a back end. All back ends draw the same bytes:
      - 'wasm' copies the picture of `render` to the canvas.
      - 'webgpu' renders on the GPU. Each streamed scene has a pool on the GPU, of `pool` bytes at most (default 2^28).
        A frame draws the nearest coarser chunk in place of a chunk that the pool lacks. After a frame, at most 8 MiB
        of the chunks that it lacked go to the pool, and `Paging.changed` is called. `draw` throws if the pool has no
        room for 16 chunks. In a pool with less room than the budget, the picture stays coarser.
      - 'webgl2' prepares the picture on the processor and draws the picture on the GPU.

      The promise is rejected if the canvas has a context of another kind, or if the platform lacks the back end. The
      scenes must be loaded with the same `simd` and `threads`. For 'webgpu', the canvas may be null, and `device`
      may be a device of the caller. */
  static open(
    canvas: HTMLCanvasElement | OffscreenCanvas | null,
    backend: 'webgpu',
    options?: LoadOptions & { device?: GPUDevice; pool?: number }
  ): Promise<Screen & { readonly device: GPUDevice }>
  static open(
    canvas: HTMLCanvasElement | OffscreenCanvas | null,
    backend: Backend,
    options?: LoadOptions & { device?: GPUDevice; pool?: number }
  ): Promise<Screen>
  /** The back end that draws this Screen, as given to `Screen.open`. */
  readonly backend: Backend
  /** True if the WebGL context or the WebGPU device was lost; `draw` then throws an Error. Open a new Screen to
      continue. A new WebGL Screen needs another canvas. */
  readonly lost: boolean
  /** The WebGL 2 context of the canvas with the back end 'webgl2'; undefined with other back ends. */
  readonly gl: WebGL2RenderingContext | undefined
  /** The GPU device of the back end 'webgpu'; undefined with other back ends. */
  readonly device: GPUDevice | undefined
  /** The time in milliseconds that the device took for the shaders of the last complete picture. Undefined without
      'webgpu', and for a device without the feature timestamp-query. */
  readonly milliseconds: number | undefined
  /** Draws objects as `render` does, and sets the canvas to the size of the picture. With 'webgpu', the picture is
      complete at the latest when `finish` is fulfilled. If several pictures wait, only the last picture is shown.

      With 'webgpu', two cameras draw two eyes in one submission, with the bytes of `renderStereo`: side by side on the
      canvas, or into the targets `into`. */
  draw(objects: readonly Placed[], camera?: Camera | readonly [Camera, Camera], options?: ScreenOptions): Drawn
  /** Returns a promise that is fulfilled when the GPU has completed all pictures. With 'webgpu', the promise is
      rejected if the last picture failed. A failed picture is not shown, and `draw` may be called again. */
  finish(): Promise<void>
  /** Returns the pixels of the last picture from the top row down, four bytes each: red, green, blue, alpha. The
      back end 'webgpu' returns a promise of the pixels. */
  pixels(): Pixels | Promise<Pixels>
  /** Drops the device's copy of a scene that an Editor has changed. */
  forget(scene: Scene): void
  /** Frees the memory of the Screen. The canvas keeps its picture. Further calls do nothing. */
  free(): void
}

/** A clock that chooses the size of moving pictures from their drawing times (fixsplat/pace.h). Experimental. */
export class Pace {
  private constructor()
  static open(options?: LoadOptions): Promise<Pace>
  /** Begins anew. `milliseconds` is the time of a frame, 0.1 to 2000. `scale` is the first picture's width as a share
      of the full width, `least` the smallest share, 1/64 to 1; both are 1 by default. */
  begin(options: { milliseconds: number; least?: number; scale?: number }): void
  /** Takes the drawing time of a picture of the chosen size, and chooses the next picture's size. */
  step(milliseconds: number): void
  readonly scale: number
  /** True if even pictures of the smallest size take too long. */
  readonly isTooSlow: boolean
  free(): void
}

/** Encodes a picture as a .png file. `pixels` has rows from the top, with four bytes a pixel: red, green, blue, alpha.
    An iterable has the picture in parts of whole rows, as `FrameOptions.rows` renders them. */
export function png(
  pixels: Uint8ClampedArray | AsyncIterable<Uint8ClampedArray>, width: number, height: number,
): Promise<Bytes>
