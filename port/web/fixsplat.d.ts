/** Whether this machine runs the WebAssembly module with simd128, the vector instructions. `load` then uses it. */
export const hasSimd: boolean

/** Whether machine and browser also have relaxed simd128, which makes the module with simd128 a quarter faster. The
    pictures are the same. */
export const hasRelaxed: boolean

/** Pixels in memory of their own, as ImageData takes them: Uint8ClampedArray<ArrayBuffer> where TypeScript (5.7 and
    later) tells kinds of memory apart. */
export type Pixels = ReturnType<typeof Uint8ClampedArray.of>

/** Bytes in memory of their own, as Blob and Response take them. */
export type Bytes = ReturnType<typeof Uint8Array.of>

/** Where the files of the package are (*.wasm, *.js, viewer/), as a folder that a server answers for: for bundlers that do not carry them on. To be called before anything is loaded. */
export function setAssets(folder: string | URL): void

/** Three numbers: x, y, z, or red, green, blue. */
export type Vector = readonly [number, number, number]

/** Options of `load` and `Screen.open`. The latter reads only `simd` and `threads`. */
export interface LoadOptions {
  /** How a file of any format but .fxs is packed. At degree 3 of the spherical harmonics (SH, the colours that change
      with the direction of view), a Gaussian takes 63.5 bytes with 'default', 39.6 with 'compact' and 19.6 with
      'small'. 'default' by default. */
  profile?: 'default' | 'compact' | 'small'
  /** The directions of the axes x, y, z of an .spz file: 'rub' is right, up, back, and 'rdf' is right, down, front.
      'file', the default, takes the axes that the file states. */
  axes?: 'file' | 'rub' | 'rdf'
  /** The largest number of Gaussians that a file of any format but .fxs may have; a larger scene is an Error. The
      default is a million, and one more for each byte of the file, but at most 2 ** 26. */
  maxGaussians?: number
  /** The largest number of bytes of memory that reading a file of any format but .fxs may take; to need more is an
      Error. Without it, the limit follows from the number of Gaussians that the file may have. */
  maxMemory?: number
  /** A function that is called now and then with the progress of the download and of the preparation. */
  progress?: (progress: Progress) => void
  /** A function that is called with a preview: a scene of at most 100,000 of the Gaussians that have arrived so far,
      without SH and enlarged. It is called while a .ply, .splat, .ksplat or compressed .ply file is downloaded from a
      server that states the length of the file, and before a large scene of any format but .fxs is packed. The
      function, or the page, must call `free` on the preview. Where the function returns a promise, loading goes on
      after the promise is fulfilled. */
  preview?: (scene: Scene) => void | Promise<void>
  /** Ends loading: the promise is then rejected with the signal's reason, and its requests end. It does nothing to a scene
      that is there. */
  signal?: AbortSignal
  /** Milliseconds in which a server must send 1000 bytes of a file, so that a request is not given up; 30000 by
      default. Time in which `preview` keeps the download waiting does not count. */
  silence?: number
  /** False chooses the WebAssembly module without simd128; the default is `hasSimd`. All scenes of one picture must be
      loaded with the same `simd` and the same `threads`. */
  simd?: boolean
  /**
   * The number of threads that draw, 1 to 64, the caller's thread included. The default is the number of processors, at
   * most 8. Without simd128 there is always one thread, and also in a page where `crossOriginIsolated` is not true. A
   * server isolates a page by the headers Cross-Origin-Opener-Policy: same-origin and Cross-Origin-Embedder-Policy:
   * require-corp. The pictures do not depend on the number of threads.
   */
  threads?: number
  /**
   * How an .fxs with levels of detail is loaded from an http address that ends in .fxs, of a server that answers ranges.
   * `load` then fetches no more than the tables of the file and the coarsest parts. Pictures are drawn at once, by what
   * is there, and what they lack is fetched, the most important first; `changed` tells when to draw again. Once nothing
   * is missing, a picture has the bytes that the whole file gives. False: the whole file is downloaded first, as from
   * any other server.
   */
  paging?: false | Paging
}

/** Options of scenes that come in parts. */
export interface Paging {
  /** Bytes of memory for the parts that are there, beside 290 bytes of tables for each 256 Gaussians; 512e6 by default,
      and less where there is no room. What was not wanted for longest goes first, the coarsest parts stay. A picture
      can have a `budget` of half the Gaussians that have room; without a budget it has at most 1,000,000, and all of
      a smaller scene. */
  memory?: number
  /** Bytes that the browser keeps on disk for the next visit, of all scenes together; 1e9 by default, and 0 for none.
      They are kept by address and version, so the server must send ETag or Last-Modified, and the page must be secure.
      Not in Node. */
  cache?: number
  /** Requests at a time; 6 by default. */
  requests?: number
  /** As `LoadOptions.silence`, also for parts that pictures want later. */
  silence?: number
  /** A function that is called when parts have come, at most every 50 ms; and with an Error, once, when no more can
      come, as the file has changed on the server, is damaged, or the server fails again and again. The scene can still
      be drawn. After an error of the network, pictures ask again. */
  changed?: (error?: Error) => void
}

/** How far `load` has come. */
export interface Progress {
  /** 'download' while a file is fetched, then 'prepare' while it is read and packed. */
  stage: 'download' | 'prepare'
  /** The share of the stage that is done, 0 to 1. It is missing where the length of a download is not known. */
  done?: number
  /** The number of bytes that have been downloaded so far, of all files of the scene; missing in the stage 'prepare'. */
  bytes?: number
}

/** Opens a scene file of one of these formats: @FORMATS@.
    `source` is an address (in Node also a path), the bytes of a file, a Blob, or a list of files. The other files that
    a scene file names are fetched from the folder of the scene file or below it, and no others. In a list of files they
    are found by their webkitRelativePath or name. A file may have 2 GB, all files of a scene 4 GB. What does not begin as
    a scene, or is far longer than its header says, is not downloaded to its end. An answer that leads from https to http
    is refused. The promise is rejected with an Error that states the reason where the scene cannot be opened. */
export function load(
  source: string | URL | ArrayBuffer | ArrayBufferView | Blob | Iterable<File>,
  options?: LoadOptions
): Promise<Scene>

/** A camera given by its position and the point that it looks at. Positions are in scene units. The y axis points down
    unless `up` says otherwise. Without `eye` and `up`, the camera looks at the objects from where small pictures of them
    show most, upright; that takes some 0.2 seconds once for the same objects. */
export interface LookAt {
  /** The position of the camera. Without it but with `up`, the camera shows all objects completely. */
  eye?: Vector
  /** The point that the camera looks at. The default is the middle of the objects. */
  look?: Vector
  /** The direction that is up in the picture; [0, -1, 0] by default. */
  up?: Vector
  /** The vertical field of view, 1 to 170 degrees; 50 by default. */
  fov?: number
  /** The depth of the near plane, in scene units. The default is a hundredth of half the diagonal of the box around the
      objects, and at most 0.2. */
  near?: number
  /** The size of the picture in pixels, where the frame's options give no size. */
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
      focal lengths are multiplied by the ratio of the widths, and so is the distance of the principal point from the
      middle. */
  fx: number
  /** The vertical focal length in pixels; `fx` by default. */
  fy?: number
  /** The principal point in pixels, x and y; the middle of the picture by default. */
  cx?: number
  cy?: number
  /** The depth of the near plane, in scene units; 0.2 by default. */
  near?: number
  /** True for a camera with parallel rays. `fx` and `fy` are then pixels per scene unit. False by default. */
  orthographic?: boolean
  /** The size in pixels of the picture that `fx`, `fy`, `cx` and `cy` describe; by default the size of the frame. */
  width?: number
  height?: number
}

export type Camera = LookAt | Pinhole

/** Options of a picture. */
export interface FrameOptions {
  /** The size of the picture in pixels, 1 to 16384 each. The default is the size that the camera states, or else
      1280 x 720. */
  width?: number
  height?: number
  /** The colour behind the scene as the number 0xrrggbb; black by default. */
  background?: number
  /** True for a transparent picture without a background: colours are multiplied by the coverage, and alpha is the
      coverage. False by default. */
  alpha?: boolean
  /** The highest degree of SH that is evaluated, 0 to 3; 3 by default. */
  shDegree?: 0 | 1 | 2 | 3
  /** Where a Gaussian ends. 'mahalanobis', the default: at a Mahalanobis distance of 3. 'square': it reaches all tiles
      of 16x16 pixels that a square of side 6 sigma about its centre touches, as in Kerbl et al. 2023; sigma is the
      largest standard deviation of the Gaussian in the picture. */
  cutoff?: 'mahalanobis' | 'square'
  /** Of scenes with levels of detail (`fixsplat convert --levels`), the largest number of Gaussians that is drawn: coarse
      Gaussians take the place of what the picture shows least. All objects share the budget. Without it, all Gaussians
      are drawn; so are those of scenes without levels. */
  budget?: number
  /** Of such scenes, a size in pixels, 1/256 to 16384: what is smaller is not drawn more finely. It may be combined with
      a budget. */
  detail?: number
  /** Of scenes that come in parts: false draws what is there, and has nothing fetched for it. True by default. */
  fetch?: boolean
  /** The largest number of bytes of working memory. With less memory than a whole frame needs, the same picture takes
      longer; too little memory is an Error. */
  maxMemory?: number
}

/** What a picture was made of. */
export interface Drawn {
  /** The Gaussians that were drawn, seen or not: with a budget at most as many, or 256 for each scene. */
  readonly drawn: number
  /** The parts of the scene that were not there yet and that coarser ones stand for; see `LoadOptions.paging`. With 0
      the picture is what it is to be. */
  readonly missing: number
}

/** The pictures that a frame writes. The frame has each target that is named here, and a target that is not named costs
    no time. `occluder` and `backdrop` are pictures that the frame reads. An array of the wrong length is an Error. */
export interface Targets {
  /** The colours, in a format. 'rgba8': four bytes a pixel. 'premultiplied': four bytes a pixel, red, green and blue
      times the coverage, and the coverage. 'premultiplied16': the same with four numbers of 0 to 65535 a pixel.
      'rgb565': one number of 16 bits a pixel. True stands for 'rgba8', or for 'premultiplied' where `alpha` is true. */
  colour?: boolean | 'rgba8' | 'premultiplied' | 'rgb565' | 'premultiplied16'
  /** The share of the light that the Gaussians at a pixel take, times 255. */
  coverage?: boolean
  /** The depth of the Gaussian at which the Gaussians of a pixel, near to far, have taken half of the light. */
  depth?: boolean
  /** The mean depth of the Gaussians at a pixel, each weighted by its contribution. */
  meanDepth?: boolean
  /** The object and the Gaussian that contribute most to a pixel. */
  ids?: boolean
  /** Input: a depth for each pixel, in the units of `Frame`, of things that are drawn already. A Gaussian whose centre
      is farther adds nothing to that pixel. */
  occluder?: Uint32Array
  /** Input: a picture that takes the place of the background, four bytes a pixel: red, green, blue, and a byte that is
      not read. It cannot be combined with the formats 'premultiplied' and 'premultiplied16'. */
  backdrop?: Uint8ClampedArray | Uint8Array
}

/** The targets that were asked for, each an array of the rows of pixels from the top. Depths are distances along the z
    axis of the camera, in scene units times 2 ** depthBits. The value 2 ** 32 - 2 stands for all depths that are too
    large for these numbers, and 2 ** 32 - 1 for a pixel without a depth. */
export interface Frame extends Drawn {
  readonly width: number
  readonly height: number
  /** Uint16Array for the formats 'rgb565' and 'premultiplied16', Uint8ClampedArray for the others. */
  readonly colour?: Pixels | Uint16Array
  readonly coverage?: Uint8Array
  readonly depth?: Uint32Array
  readonly meanDepth?: Uint32Array
  /** Two numbers a pixel, for the Gaussian that contributes most: the id of its object, and its number in the packed
      scene. Both are 2 ** 32 - 1 where no Gaussian contributes. */
  readonly ids?: Uint32Array
}

/** Options of a picture with named targets. */
export interface TargetOptions extends FrameOptions {
  targets: Targets
  /** The number of binary digits of a depth after the point, 1 to 28; 16 by default. */
  depthBits?: number
}

/** Options of two pictures, one for each eye. */
export interface StereoOptions extends FrameOptions {
  /** True: each eye has exactly the bytes that `render` gives for its camera, in the time of two frames. False, the
      default: the colours of the Gaussians are computed once for both eyes, which is faster. */
  exact?: boolean
}

/** Options of two pictures with named targets. */
export interface StereoTargetOptions extends StereoOptions {
  /** One value for both eyes, or one for each eye. Both eyes have the same format of colours. */
  targets: Targets | readonly [Targets, Targets]
  /** The number of binary digits of a depth after the point, 1 to 28; 16 by default. */
  depthBits?: number
}

/** A box in the coordinates of the scene, which decides by their centres which Gaussians are drawn. */
export interface Crop {
  /** The corner of the box with the smallest x, y and z, in scene units. */
  low: Vector
  /** The corner of the box with the largest x, y and z, in scene units. */
  high: Vector
  /** 'inside', the default: Gaussians outside of the box are left out. 'outside': Gaussians inside the box are left
      out. */
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
  /** The number that the target `ids` has for this object, 0 to 2 ** 32 - 2. The default is its index among the
      objects. */
  id?: number
  /** At most 8 boxes. A Gaussian is drawn where it lies in at least one box of the kind 'inside', if there is any, and
      in no box of the kind 'outside'. */
  crops?: readonly Crop[]
}

/** The Gaussian that contributes most to a pixel. */
export interface Picked {
  /** The index of its object among the objects. */
  object: number
  /** Its number in the packed scene. */
  gaussian: number
  /** The distance of its centre along the z axis of the camera, in world units. */
  depth: number
  /** The point of the world at this depth on the ray through the pixel, in world units. */
  position: [number, number, number]
}

/** A packed scene in the memory of a WebAssembly module. `load` makes it. After `free`, drawing it throws an Error. */
export class Scene {
  private constructor()
  /** The name of its file, or 'scene' for bytes without a name. */
  readonly name: string
  /** The number of Gaussians. */
  readonly count: number
  /** Whether it has levels of detail, of which `budget` and `detail` make use. */
  readonly levels: boolean
  /** Whether it comes in parts; see `LoadOptions.paging`. */
  readonly paged: boolean
  /** Why no more parts come, or null. */
  readonly failure: Error | null
  /** The degree of its SH, 0 to 3. */
  readonly shDegree: number
  /** How the scene is packed. */
  readonly profile: 'default' | 'compact' | 'small'
  /** The least x, y, z (`low`) and the greatest x, y, z (`high`) of the visible part of the scene, in scene units. */
  readonly low: number[]
  readonly high: number[]
  /** The size of the packed scene in bytes. */
  readonly bytes: number
  /** Where the scene is seen from at first: the direction that is up in it, a box `low` to `high`, the direction from
      the middle of the box to the camera, and the part (0.5 to 1) of the distance from which all of the box is seen. The
      box is that of the scene, or of its core where surroundings reach far beyond. For a view from within the scene,
      `part` is 0: the camera is in the middle of the box, and looks against `from`. `known`: the .fxs says what is up,
      as those of `fixsplat fit` do; else it was found in small pictures. */
  readonly first: { up: number[]; from: number[]; part: number; low: number[]; high: number[]; known: boolean }
  /** The start view that the .fxs keeps, for a picture of 2 x 2 pixels, or null. `render` takes it without a camera. */
  readonly start: Pinhole | null
  /** The number of threads that draw the scene at the moment. Pictures do not wait for threads that have not started
      yet. */
  readonly threads: number
  /** A copy of the packed scene, which has the bytes of an .fxs file. Throws an Error where it comes in parts. */
  readonly packed: Bytes
  /** Draws the scene by itself, as the function `render` draws objects. */
  render(camera: Camera, options: TargetOptions): Frame
  render(camera?: Camera, options?: FrameOptions): Pixels
  /** Draws the scene by itself for two eyes, as the function `renderStereo` draws objects. */
  renderStereo(left: Camera, right: Camera, options: StereoTargetOptions): [Frame, Frame]
  renderStereo(left: Camera, right: Camera, options?: StereoOptions): [Pixels, Pixels]
  /** Finds the Gaussian of the scene at a pixel, as the function `pick` does. */
  pick(x: number, y: number, camera?: Camera, options?: FrameOptions): Picked | null
  /** The same as the function `foresee`, for the scene by itself. */
  foresee(camera?: Camera, options?: FrameOptions): number
  /** Waits until nothing is missing that a picture of the scene needs. Rejected where that is not to be had. */
  complete(camera?: Camera, options?: FrameOptions): Promise<void>
  /** Frees the memory of the scene. It may be called again. */
  free(): void
}

/** Ends the threads that no scene and no Screen needs, and frees their memory. Without this call, the threads wait for
    the next scene. It must not be called while a scene is being loaded. */
export function end(): Promise<void>

/** Draws objects into one picture, with all their Gaussians in one order by depth. Returns the pixels from the top row
    down, four bytes each: red, green, blue, alpha. With `targets`, it returns a Frame of the named targets instead.
    Throws an Error that states the reason where the arguments are not valid or memory is too small. */
export function render(objects: readonly Placed[], camera: Camera, options: TargetOptions): Frame
export function render(objects: readonly Placed[], camera?: Camera, options?: FrameOptions): Pixels

/** Draws objects for two eyes with pictures of the same size, in less time than two calls of `render`. `maxMemory` must
    be enough for both whole frames at once. Returns the left and the right picture. */
export function renderStereo(
  objects: readonly Placed[], left: Camera, right: Camera, options: StereoTargetOptions): [Frame, Frame]
export function renderStereo(
  objects: readonly Placed[], left: Camera, right: Camera, options?: StereoOptions,
): [Pixels, Pixels]

/** Where objects are seen from at first, as `Scene.first` says of one. It takes some 0.2 seconds once for the same
    objects. */
export function firstView(objects: readonly Placed[]): Scene['first']

/** For scenes that come in parts (`LoadOptions.paging`): has fetched what a picture from this camera will lack, after all
    that the last picture lacks. Draws nothing, and does not wait. Returns the number of parts that are missing. */
export function foresee(objects: readonly Placed[], camera?: Camera, options?: FrameOptions): number

/** Finds the Gaussian that contributes most to the pixel in column x and row y, counted from 0 at the top left. Returns
    null where no Gaussian contributes. */
export function pick(x: number, y: number, objects: readonly Placed[], camera?: Camera, options?: FrameOptions): Picked | null

/** Where a Screen of the back end 'webgpu' draws in place of its whole canvas: textures of its device. They are read
    and written until `finish` is fulfilled. */
export interface IntoTexture {
  /** A texture with the usage RENDER_ATTACHMENT and the format rgba8unorm, bgra8unorm, rgba16float or rgba32float. The
      colours are those of an sRGB picture. Without it, the picture is drawn into a part of the Screen's canvas, which
      keeps its size and what is beside the picture. */
  texture?: GPUTexture
  /** The pixel of the texture, from its top left corner, for the top left corner of the picture; 0 and 0 by default. */
  x?: number
  y?: number
  /** The depth buffer of what is drawn already, in a depth format and with the usage TEXTURE_BINDING, at the same
      pixels: a Gaussian whose centre is farther adds nothing to that pixel. `planes` are the distances from the
      camera, in scene units, that 0 and 1 stand for. Either may be the farther one, which hides nothing and may be
      Infinity. `linear`: values between them stand for distances between, as an orthographic camera has them; false,
      the default, for those of a camera with perspective. */
  depth?: { texture: GPUTexture; planes: readonly [number, number]; linear?: boolean }
  /** With `alpha`: true blends the picture over what is in the texture. False, the default, replaces that. */
  over?: boolean
}

/** What a Screen of the back end 'webgpu' copies into buffers of its device, beside the picture: the targets of a
    Frame, as numbers of 32 bits in the rows of pixels from the top. A buffer needs the usage COPY_DST and 4 bytes a
    pixel, for `ids` 8. It is written when the picture is whole, at the latest when `finish` is fulfilled. `colour` has
    four bytes a pixel: red, green, blue, alpha. */
export interface IntoBuffers {
  colour?: GPUBuffer
  depth?: GPUBuffer
  meanDepth?: GPUBuffer
  ids?: GPUBuffer
}

/** Options of a picture that is drawn on a Screen. */
export interface ScreenOptions extends FrameOptions {
  /** For the back end 'webgpu'. A Screen without a canvas may draw `targets` alone. */
  targets?: IntoBuffers
  /** The number of binary digits of these depths after the point, 1 to 28; 16 by default. */
  depthBits?: number
  /** For the back ends of WebGL 2: draws into a framebuffer of the Screen's context in place of the canvas. `x` and `y`
      are the pixel of the framebuffer for the lower left corner of the picture, 0 and 0 by default. The default
      `framebuffer` is null, the canvas itself, which then keeps its size. `depth` is for 'webgl2': the texture of a
      depth buffer with perspective, whose lowest left texel is that of the picture, and its `planes` as in IntoTexture;
      the texture has no filter but NEAREST. */
  into?:
    | {
        framebuffer?: WebGLFramebuffer | null
        x?: number
        y?: number
        depth?: { texture: WebGLTexture; planes: readonly [number, number] }
      }
    | IntoTexture
  /** A picture in place of the background, as `Targets.backdrop`. Not with `alpha`, nor with 'webgl2-quads'. The other
      three draw the same bytes over it. */
  backdrop?: Uint8ClampedArray | Uint8Array
}

type Backend = 'wasm' | 'webgl2' | 'webgl2-quads' | 'webgpu'

/** A canvas for any number of pictures, one after the other, in the page or in a Worker. A canvas keeps the kind of its
    context, so a Screen of another kind needs another canvas. After `free`, using the Screen throws an Error. */
export class Screen {
  private constructor()
  /**
   * Opens a canvas with a back end. 'wasm' copies the picture of `render` to the canvas. 'webgpu' renders the same
   * bytes on the GPU, to which it copies a scene once. 'webgl2' prepares the same bytes on the processor, and draws
   * them on the GPU. 'webgl2-quads' draws on the GPU too, but its picture is not exact. The promise is rejected where
   * the canvas already has a context of another kind, and, for all but 'wasm', where there is no WebGPU or WebGL 2, or
   * no simd128. The scenes that will be drawn must be loaded with the same `simd` and `threads`. For 'webgpu' the canvas
   * may be null, and `device` is a device of the caller; without it, all Screens share one. It cannot draw scenes that
   * come in parts.
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
  /** The back end that `open` was given. */
  readonly backend: Backend
  /** Whether the WebGL context or the WebGPU device was lost. `draw` then throws an Error; a new Screen can go on, of
      WebGL on another canvas. */
  readonly lost: boolean
  /** The WebGL 2 context of the canvas; undefined with other back ends. */
  readonly gl: WebGL2RenderingContext | undefined
  /** The device of the back end 'webgpu'; undefined with others. */
  readonly device: GPUDevice | undefined
  /** Draws objects as `render` does, and sets the canvas to the size of the picture. With the back end 'webgpu' the
      canvas keeps its picture until the next one is whole, at the latest when `finish` is fulfilled; of pictures that
      are drawn while one is on its way, only the last is shown. */
  draw(objects: readonly Placed[], camera?: Camera, options?: ScreenOptions): Drawn
  /** Is fulfilled when the GPU has completed all pictures that were drawn. With the back end 'webgpu' it is rejected
      with an Error of one line where the last of them could not be drawn; nothing of that is shown then, and the next
      may be drawn. */
  finish(): Promise<void>
  /** The last picture: the pixels from the top row down, four bytes each: red, green, blue, alpha. With the back end
      'webgpu' a promise of them. */
  pixels(): Pixels | Promise<Pixels>
  /** Frees the memory of the Screen. The canvas keeps its picture. It may be called again. */
  free(): void
}

/** Makes the bytes of a .png file from the pixels of a picture: rows from the top, four bytes a pixel, red, green,
    blue, alpha. */
export function png(pixels: Uint8ClampedArray, width: number, height: number): Promise<Bytes>
