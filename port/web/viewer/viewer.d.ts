import type { Vector } from 'fixsplat'

type How = boolean | AddEventListenerOptions
export type Backend = 'wasm' | 'webgl2' | 'webgpu'

export interface ViewerCamera {
  /** The position of the camera, in scene units. */
  eye: [number, number, number]
  /** The point that the camera looks at and turns about, in scene units. */
  look: [number, number, number]
  /** The direction that points up in the picture. */
  up: [number, number, number]
  /** The vertical field of view, 1 to 170 degrees. */
  fov: number
  /** True for an orthographic camera. */
  flat: boolean
  /** The offset of the camera's axis from the middle of the picture, right and down, in heights of the picture. */
  shift: [number, number]
}

/** Some fields of a camera; the other fields stay unchanged. */
export type SomeCamera = { [Name in keyof ViewerCamera]?: Readonly<ViewerCamera[Name]> }

/** The placement of a scene, as in the attributes of <fixsplat-scene>. */
export interface Place {
  /** The position of the scene in world units; 0 0 0 by default. */
  position?: Vector | string | null
  /** The rotation of the scene: degrees about x, then y, then z, or a quaternion w, x, y, z. No rotation by default. */
  rotation?: Vector | readonly [number, number, number, number] | string | null
  /** The scale of the scene, above 0; 1 by default. */
  scale?: number | string | null
  /** A factor for the opacity, 0 to 1; 1 by default. */
  opacity?: number | string | null
  /** Factors for red, green and blue, 0 to 4 each; 1 1 1 by default. */
  tint?: Vector | string | null
  /** Seconds that a moving scene is ahead of the viewer's time; 0 by default. */
  time?: number | string | null
}

/** The element <fixsplat-scene>, which adds a scene to the <fixsplat-viewer> around it. The attribute `hidden` hides
    the scene. Each property sets an attribute, so reading a property returns text. */
export class PlacedScene extends HTMLElement {
  get src(): string | null
  set src(address: string | null)
  get position(): string | null
  set position(value: Place['position'])
  get rotation(): string | null
  set rotation(value: Place['rotation'])
  get scale(): string | null
  set scale(value: Place['scale'])
  get opacity(): string | null
  set opacity(value: Place['opacity'])
  get tint(): string | null
  set tint(value: Place['tint'])
  get time(): string | null
  set time(value: Place['time'])
  /** A file, or the files of one scene, to show instead of the address in the attribute `src`. Set `source` before the
      element is put into a viewer. */
  source: File | File[] | null
}

export interface ShownScene {
  /** The source of the scene: its address, its file or its files. */
  source: string | File | File[]
  name: string
  /** The number of Gaussians of the scene. */
  count: number
  /** The smallest (`low`) and the largest (`high`) x, y, z of the scene, in scene units. */
  low: number[]
  high: number[]
  /** The <fixsplat-scene> element of the scene; null for a scene opened by the attribute `src` or the method `open`. */
  element: PlacedScene | null
}

/** The Gaussian at a pixel, found by `pick`. */
export interface Found {
  /** The point on the ray through the pixel, in world coordinates. */
  position: [number, number, number]
  /** The distance of the point from the camera along the camera's axis, in world units. */
  depth: number
  /** The index of the Gaussian in the packed scene. */
  gaussian: number
  scene: ShownScene
}

export interface Settings {
  /** The background colour, #rrggbb. The default is dark or light, as the system prefers. */
  background: string
  /** The back end that draws: 'wasm', 'webgpu' or 'webgl2'; '' chooses the fastest back end. */
  backend: Backend | ''
  /** The largest number of Gaussians in a picture, for scenes with levels of detail; 0, the default: no limit. */
  budget: number
  /** The smallest detail to draw in pixels, for scenes with levels of detail; 0, the default: no limit. */
  detail: number
  /** True turns the scene while the user does nothing. */
  turn: boolean
  /** The mode in which the user moves the camera; 'orbit' by default. */
  mode: 'orbit' | 'fly' | 'walk'
  /** The height of the eye above the ground while walking, in scene units. The default is 0: estimated from the
      start view or from the height of the scene. */
  eyeHeight: number
  /** A factor for the speed of flying and walking, 0.1 to 2; 0.5 by default. */
  speed: number
  fov: number
  flat: boolean
  /** The up direction of the scene. */
  up: number[]
  /** The resolution of the picture as a share of the device pixels in width and height, 0.25 to 1; 1 by default. */
  sharpness: number
  /** True draws colours that depend on the direction of view (spherical harmonics). True by default. */
  colours: boolean
  /** The tone curve of the shown picture; 'linear', the default, changes nothing. Tone curve, exposure and vignette
      change the picture on the screen, not the pixels of the canvas, of saved pictures and of films. */
  tone: 'linear' | 'filmic' | 'hejl' | 'aces'
  /** The exposure of the shown picture in stops: 1 doubles the light; 0 by default. */
  exposure: number
  /** The darkness of the corners of the shown picture, 0 to 1; 0 by default. */
  vignette: number
  /** The size of a picture that the user saves, as a factor for the size of the shown picture; 1 by default. */
  enlarge: number
  /** True shows the frame rate and other numbers of the picture. */
  readout: boolean
  /** The size of the scene in AR. 'table', the default, makes the longest side half a metre. 'true' makes a scene
      unit a metre. 'off' does not offer AR. */
  ar: 'table' | 'true' | 'off'
}

/** An Error with a message for the user of the page, in the language of the viewer. `cause` is the original Error. */
export interface ViewerError extends Error {
  kind: 'format' | 'damaged' | 'missing' | 'network' | 'memory' | 'browser' | 'policy' | 'other'
  /** The scene that could not be opened; undefined if the error concerns no scene. */
  source?: string | File | File[]
}

/** The events of the element <fixsplat-viewer>. The events do not bubble. */
export interface ViewerEvents {
  load: CustomEvent<ShownScene>
  /** The progress of loading a scene. `done` is the completed share of the stage, 0 to 1; undefined if unknown.
      `bytes` is the number of downloaded bytes. */
  progress: CustomEvent<{
    source: ShownScene['source']; name: string; element: PlacedScene | null
    stage: 'download' | 'prepare'; done?: number; bytes?: number
  }>
  /** An error has occurred. The property `error` of the event is a ViewerError. */
  error: ErrorEvent
  /** The camera has changed. `byHand` is true for input by pointer, key or gamepad, false for a program. */
  camera: CustomEvent<{ camera: ViewerCamera; byHand: boolean }>
  /** The mode (orbit, fly or walk) has changed. */
  mode: CustomEvent<{ mode: Settings['mode'] }>
  /** A click on the scene. `x` and `y` are CSS pixels of the element. `found` is null if no Gaussian is at the
      pixel. */
  pick: CustomEvent<{ x: number; y: number; found: Found | null }>
  /** A picture is shown. `drawn` is the number of Gaussians. `missing` is the number of parts of streamed scenes that
      have not arrived. The width and height of the picture were divided by `divisor` because the camera moves; 1 at
      rest. */
  frame: CustomEvent<{
    width: number; height: number; divisor: number; milliseconds: number; backend: Backend
    drawn: number; missing: number
  }>
  /** The caption of an annotation was opened or closed. After closing, `index` is -1 and `annotation` is null. */
  annotation: CustomEvent<{ index: number; annotation: Annotation | null }>
  /** A camera track or a moving scene was started, was paused, has ended, or shows another time. `time` is in seconds.
      `track` is null for a moving scene. */
  play: CustomEvent<{ track: number | null }>
  pause: CustomEvent<{ track: number | null }>
  ended: CustomEvent<{ track: number | null }>
  timeupdate: CustomEvent<{ track: number | null; time: number }>
  /** The sound of a moving scene was switched on or off, by the user, the page or the browser, or has another volume. */
  volumechange: CustomEvent<{ muted: boolean; volume: number }>
  /** The pictures of both eyes were drawn for VR, or pictures for AR. `scale` is the width and height of the pictures
      as a share of the viewport. */
  eyes: CustomEvent<{ cameras: EyeCamera[]; width: number; height: number; scale: number; milliseconds: number }>
}

export interface Pose {
  eye: Vector
  look: Vector
  /** The direction that points up in the picture; the up direction of the scene by default. */
  up?: Vector
  /** The vertical field of view, 1 to 170 degrees. */
  fov: number
  /** True if `fov` is the field of view of the longer side of the picture, as in supersplat-viewer. False by
      default. */
  longer?: boolean
}

/** A title and a text at a position in the world. */
export interface Annotation {
  position: Vector
  /** The title: plain text, at most 200 characters. */
  title?: string
  /** The text: plain text with line breaks, at most 5,000 characters. */
  text?: string
  /** The camera that shows the annotation. The default turns the camera to the annotation and moves the camera
      nearer. */
  camera?: Pose
}

/** A camera track: a path of the camera along cubic curves through its keys. */
export interface CameraTrack {
  name?: string
  /** The behaviour at the end of the track. 'none', the default, stops there. 'repeat' starts again, and 'pingpong'
      plays the track backwards. */
  loop?: 'none' | 'repeat' | 'pingpong'
  /** The duration in seconds; the time of the last key by default. */
  duration?: number
  /** The smoothness of the path, 0 to 1; 1 by default. 0 means straight lines with a stop at each key. */
  smoothness?: number
  /** True shows each key until the time of the next key, without motion between. False by default. */
  step?: boolean
  /** True if `fov` of all keys is the field of view of the longer side of the picture. False by default. */
  longer?: boolean
  /** The keys of the track, 1 to 10,000. `time` is in seconds and increases from key to key. */
  keys: readonly (Omit<Pose, 'longer'> & { time: number })[]
}

/** The content of a settings file. Settings files of supersplat-viewer, versions 1 and 2, are read too. */
export interface SettingsFile
  extends Partial<Omit<Settings, 'backend' | 'fov' | 'flat' | 'up' | 'readout'>> {
  /** The version of the format of settings files. */
  fixsplat: 1
  /** The start view of the camera. */
  camera?: Pose
  /** The address of an equirectangular picture in the folder of the settings file or below, or a data: address. */
  skybox?: string
  annotations?: readonly Annotation[]
  tracks?: readonly CameraTrack[]
  /** The action after the scene is loaded. 'track' plays the first track, 'annotation' opens the first annotation.
      'camera', the default, shows the start view. */
  start?: 'camera' | 'track' | 'annotation'
}

export interface FilmOptions {
  /** The index of the track to film, from 0; the selected track by default. */
  track?: number
  /** The size of the film in pixels, rounded to even numbers. The default is the size of the viewer's picture. */
  width?: number
  height?: number
  /** The number of frames a second, 1 to 120; 30 by default. */
  rate?: number
  /** The bit rate in bits a second. The default is a constant quality if the encoder supports that, else 0.3 bits a
      pixel. */
  bitrate?: number
  /** Receives the completed share of the film, 0 to 1. An exception from this function cancels the film. */
  progress?: (share: number) => void
}

export interface Film {
  blob: Blob
  /** The encoder of the film. Without WebCodecs, 'MediaRecorder' records each frame for its duration by the clock. */
  codec: 'VP9' | 'VP8' | 'MediaRecorder'
  frames: number
  width: number
  height: number
}

/** The element <fixsplat-viewer>. Its attributes are listed in ViewerAttributes. */
export class Viewer extends HTMLElement {
  /** The state of the viewer. 'empty': no scene. 'loading': a scene or a part of a scene is loading. 'moving': the
      camera moves, or a moving scene plays. 'still': the picture is complete. */
  readonly state: 'empty' | 'loading' | 'moving' | 'still'
  /** The back end that draws; undefined before the first scene. Setting the property sets the attribute `backend`. */
  get backend(): Backend | undefined
  set backend(name: Backend | '' | null | undefined)
  /** The camera as text: eye, look, up and field of view, ten numbers separated by commas. An orthographic or
      shifted camera has three more numbers: 1 if orthographic, then `ViewerCamera.shift`. The text is empty without
      a scene. */
  get view(): string
  /** Sets the attribute `view`, the start view, as text in the format of `Viewer.view`. */
  set view(text: string | null | undefined)
  /** A link to the viewer's page that shows this scene from the present camera. */
  readonly link: string
  readonly scenes: ShownScene[]
  /** A copy of the camera; null without a scene. Setting some fields keeps the other fields. Before a scene is
      loaded, setting the camera sets the start view and needs `eye` and `look`. */
  get camera(): ViewerCamera | null
  set camera(camera: SomeCamera | null)
  /** All settings of the viewer. Setting an object changes only the settings in the object. Setting a string sets the
      attribute `settings`, the address of a settings file. */
  get settings(): Settings
  set settings(values: { [Name in keyof Settings]?: Settings[Name] | null } | string)
  /** Opens a scene: an address, a file, or the files of one scene. Returns false if the scene cannot be opened; the
      earlier scene then stays. */
  open(source: string | File | File[]): Promise<boolean>
  /** Adds a scene to the picture, as a new <fixsplat-scene> in this viewer. */
  add(source: string | File | File[], place?: Place): PlacedScene
  /** Removes the scenes opened by `src`, by `open` or by the user. Each <fixsplat-scene> of the page stays. */
  clear(): void
  /** Replaces the scene by the scene of another address, and keeps the camera. Returns false if the viewer is busy. */
  replace(source: string): Promise<boolean>
  /** Shows a view of the attribute `cameras`. The index counts from 0 and wraps around. */
  showView(index: number): void
  /** Moves the camera in `duration` milliseconds, 1000 by default; at once if the user prefers reduced motion. Returns
      true on arrival, or false if another motion of the camera came between. */
  flyTo(camera: SomeCamera, options?: { duration?: number }): Promise<boolean>
  /** Renders a .png file of the present view, `scale` times as wide and high as the shown picture (default 1, at most
      16384 pixels a side). The picture has the bytes of `fixsplat render`. */
  picture(options?: { scale?: number }): Promise<Blob>
  /** Finds the Gaussian at a point of the element, in CSS pixels; null if no Gaussian is there. */
  pick(x: number, y: number): Promise<Found | null>
  /** A copy of the annotations. A new list takes effect a moment later. An error in the list causes an event
      `error`. */
  get annotations(): Annotation[]
  set annotations(list: readonly Annotation[])
  /** A copy of the camera tracks. A new list takes effect a moment later. An error in the list causes an event
      `error`. */
  get tracks(): CameraTrack[]
  set tracks(list: readonly CameraTrack[])
  /** Opens the caption of an annotation, by its index from 0, and flies to the annotation. Returns true on arrival. */
  goTo(index: number): Promise<boolean>
  /** Plays a track, by its index from 0. Without an index, plays the moving scene, or the selected track of a still
      scene. What was paused continues. */
  play(track?: number): Promise<void>
  /** Pauses the moving scene and the selected track. */
  pause(): void
  /** Shows a moving scene at a time in seconds; a playing scene plays on from there. With a still scene, pauses the
      selected track, and shows the view of the track at the time. */
  seek(seconds: number): void
  /** The present time of the moving scene, or of the selected track of a still scene, in seconds. Setting the time is
      the same as `seek`. */
  time: number
  /** The duration of the moving scene, or of the selected track of a still scene, in seconds. */
  readonly duration: number
  readonly paused: boolean
  /** False if `paused` is true. Setting the property plays or pauses. */
  playing: boolean
  /** The speed of a moving scene, above 0 and at most 100; 1 by default. Sets the attribute `speed`. */
  get speed(): number
  set speed(speed: number | null)
  /** True if a moving scene starts again after its duration. Sets the attribute `loop`. */
  get loop(): boolean
  set loop(loops: boolean | '' | 'none' | null)
  /** The address of the sound of a moving scene; null: the sound in the scene's file, if it has one. Sets the attribute
      `sound`. */
  get sound(): string | null
  set sound(url: string | null | undefined)
  /** True if the sound of a moving scene is off. The viewer sets the property if the browser refuses sound before the
      user has touched the page. Sets the attribute `muted`. */
  muted: boolean
  /** The volume of the sound, 0 to 1; 1 by default, or as the scene's file states. Sets the attribute `volume`. */
  get volume(): number
  set volume(volume: number | null)
  /** Makes a film of a track, in which a moving scene plays from its start. Each frame is drawn completely, as by
      `fixsplat render`. The lossy codec then changes
      the pixels. */
  film(options?: FilmOptions): Promise<Film>
  /** Reads a settings file: an address, a File, or the content of a file as an object. Returns a line of text for
      each ignored part. The promise is rejected if the source is not a settings file. */
  readSettings(source: string | File | object): Promise<string[]>
  addEventListener<Name extends keyof ViewerEvents>(
    name: Name, listener: (this: Viewer, event: ViewerEvents[Name]) => void, options?: How): void
  addEventListener<Name extends keyof HTMLElementEventMap>(
    name: Name, listener: (this: Viewer, event: HTMLElementEventMap[Name]) => void, options?: How): void
  addEventListener(name: string, listener: EventListenerOrEventListenerObject, options?: How): void
  removeEventListener<Name extends keyof ViewerEvents>(
    name: Name, listener: (this: Viewer, event: ViewerEvents[Name]) => void, options?: How): void
  removeEventListener<Name extends keyof HTMLElementEventMap>(
    name: Name, listener: (this: Viewer, event: HTMLElementEventMap[Name]) => void, options?: How): void
  removeEventListener(name: string, listener: EventListenerOrEventListenerObject, options?: How): void
}

/** The attributes of <fixsplat-viewer> for frameworks such as React. `true` and '' set an attribute without a value. */
export interface ViewerAttributes {
  /** The address of a scene. */
  src?: string
  /** The address of a cameras.json file with views. */
  cameras?: string
  /** The start view, in the format of `Viewer.view`. */
  view?: string
  background?: string
  budget?: number | string
  detail?: number | string
  /** The address of a picture to show until the first picture of the scene. */
  poster?: string
  /** Two numbers that `fixsplat publish` writes. They make the poster cover the first picture exactly. */
  'poster-frame'?: string
  backend?: Backend | ''
  /** The number of drawing threads, 1 to 64; see `LoadOptions.threads`. */
  threads?: number | string
  turn?: '' | true
  /** The moment of a moving scene, in seconds. */
  time?: number | string
  /** 'false' does not play a moving scene by itself. '' plays it even if the user prefers reduced motion. */
  playing?: '' | 'false' | boolean
  /** The speed of a moving scene, above 0 and at most 100; 1 by default. */
  speed?: number | string
  /** '' repeats a moving scene, and 'none' stops it at its end. The default is what the scene's file states. */
  loop?: '' | 'none'
  /** The address of the sound of a moving scene; the sound in the scene's file by default. */
  sound?: string
  /** Switches the sound of a moving scene off. */
  muted?: '' | boolean
  /** The volume of the sound, 0 to 1; 1 by default, or as the scene's file states. */
  volume?: number | string
  /** Hides the whole interface. */
  noui?: '' | true
  /** The parts of the interface to show; all parts by default. `motion` is the bar of a moving scene. */
  ui?: '' | 'annotations' | 'tracks' | 'motion' | 'annotations tracks' | 'annotations motion' | 'tracks motion' |
    'annotations tracks motion'
  /** The name of the scene, shown in the corner of the viewer; the name of its file by default. */
  label?: string
  /** The use of the mouse wheel. 'page': the wheel scrolls the page, unless the viewer has the focus or Ctrl is
      held. */
  wheel?: 'page' | ''
  ar?: Settings['ar']
  tone?: Settings['tone']
  exposure?: number | string
  vignette?: number | string
  /** The time in seconds that a removed scene stays in memory; 60 by default. */
  keep?: number | string
  /** The address of a settings file. */
  settings?: string
  /** The number of the annotation to show, from 1. */
  annotation?: number | string
  /** The address of an equirectangular picture behind the scene. */
  skybox?: string
  /** The language: 'de', 'en' or 'zh'. The default is the first supported language of the browser. */
  lang?: string
  'eye-height'?: number | string
  /** The address of walls for walking: a .voxel.json of `fixsplat collide`, with its .voxel.bin beside it. */
  walls?: string
  /** The on-screen stick for flying and walking: '' shows the stick, 'none' hides the stick. The default shows the
      stick on touchscreens, unless `noui` or `ui` is set. */
  joystick?: '' | 'none'
  /** Offers to edit the scene by hand, in the panel of settings. */
  edit?: '' | true
}

/** The events of <fixsplat-viewer> as properties in JSX, as onframe, for React 19. */
export type ViewerHandlers = { [Name in keyof ViewerEvents as `on${Name}`]?: (event: ViewerEvents[Name]) => void }

/** A camera in the format of a cameras.json file. */
export interface EyeCamera {
  width: number
  height: number
  fx: number
  fy: number
  cx: number
  cy: number
  rotation: number[][]
  position: number[]
  near: number
}

declare global {
  interface HTMLElementTagNameMap {
    'fixsplat-viewer': Viewer
    'fixsplat-scene': PlacedScene
  }
}
