import type { Vector } from '../fixsplat.js'

type How = boolean | AddEventListenerOptions
export type Backend = 'wasm' | 'webgl2' | 'webgl2-quads' | 'webgpu'

/** Where the viewer looks from. */
export interface ViewerCamera {
  /** Scene units. */
  eye: [number, number, number]
  /** The point that it turns about. */
  look: [number, number, number]
  up: [number, number, number]
  /** The vertical field of view, 1 to 170 degrees. */
  fov: number
  /** Whether its rays are parallel. */
  flat: boolean
  /** How far right and down of the middle the axis lies, in heights of the picture. */
  shift: [number, number]
}

/** Some of a camera; what it leaves out stays as it is. */
export type SomeCamera = { [Name in keyof ViewerCamera]?: Readonly<ViewerCamera[Name]> }

/** Where a scene lies among others: as the attributes of <fixsplat-scene>. */
export interface Place {
  /** World units. */
  position?: Vector | string | null
  /** Degrees about x, then y, then z; or a quaternion w, x, y, z. */
  rotation?: Vector | readonly [number, number, number, number] | string | null
  /** Above 0. */
  scale?: number | string | null
  /** 0 to 1. */
  opacity?: number | string | null
  /** Factors for red, green and blue, 0 to 4 each. */
  tint?: Vector | string | null
}

/** <fixsplat-scene>: one more scene in the <fixsplat-viewer> around it. `hidden` leaves it out. Its properties are its
    attributes, and so texts when they are read. */
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
  /** A file, or the files of one scene, in place of `src`; to be set before the element is in a viewer. */
  source: File | File[] | null
}

/** A scene that is there. */
export interface ShownScene {
  /** Its address, or its file or files. */
  source: string | File | File[]
  name: string
  /** Gaussians. */
  count: number
  /** Its box, in its own units. */
  low: number[]
  high: number[]
  /** Its element; null for that of `src` and `open`. */
  element: PlacedScene | null
}

/** What is at a pixel. */
export interface Found {
  /** In the world. */
  position: [number, number, number]
  /** Along the camera's axis, world units. */
  depth: number
  /** Its number in the packed scene. */
  gaussian: number
  scene: ShownScene
}

/** All that a person can set, by the names of the attributes where there is one. */
export interface Settings {
  /** #rrggbb. */
  background: string
  backend: Backend | ''
  /** Gaussians of a picture, of scenes with levels of detail; 0 for all. */
  budget: number
  /** Pixels; 0 for all. */
  detail: number
  turn: boolean
  mode: 'orbit' | 'fly' | 'walk'
  /** Of the eye above the ground, for walking, scene units; 0: as the start view or the scene's own height tells. */
  eyeHeight: number
  /** Of flight and of walking, 0.1 to 2. */
  speed: number
  fov: number
  flat: boolean
  /** The direction that is up. */
  up: number[]
  /** Of width and height in device pixels, 0.25 to 1. */
  sharpness: number
  /** Whether colours change with the direction of view. */
  colours: boolean
  /** Whether pictures a second are shown. */
  readout: boolean
  /** In AR: the longest side is half a metre, or a unit is a metre, or AR is not offered. */
  ar: 'table' | 'true' | 'off'
}

/** An Error in words for people; `cause` is the one of the program. */
export interface ViewerError extends Error {
  kind: 'format' | 'damaged' | 'missing' | 'network' | 'memory' | 'browser' | 'policy' | 'other'
  /** What could not be opened, where it is about a scene. */
  source?: string | File | File[]
}

/** What a <fixsplat-viewer> tells. None of these bubbles. */
export interface ViewerEvents {
  /** A scene is whole. */
  load: CustomEvent<ShownScene>
  /** How far a scene has come: `done` is a share, where that is known, and `bytes` have come. */
  progress: CustomEvent<{
    source: ShownScene['source']; name: string; element: PlacedScene | null
    stage: 'download' | 'prepare'; done?: number; bytes?: number
  }>
  /** `error` is a ViewerError. */
  error: ErrorEvent
  /** The camera has changed: by a pointer or a key, or else by a program. */
  camera: CustomEvent<{ camera: ViewerCamera; byHand: boolean }>
  /** People turn the scene, fly or walk from now on. */
  mode: CustomEvent<{ mode: Settings['mode'] }>
  /** A click on the scene, in CSS pixels of the element. */
  pick: CustomEvent<{ x: number; y: number; found: Found | null }>
  /** A picture is shown: `drawn` Gaussians, with `missing` parts that are still to come; `divisor` is what its width
      and height were divided by while the camera moved. */
  frame: CustomEvent<{
    width: number; height: number; divisor: number; milliseconds: number; backend: Backend
    drawn: number; missing: number
  }>
  /** The caption of an annotation is opened, or closed: then `index` is -1 and `annotation` null. */
  annotation: CustomEvent<{ index: number; annotation: Annotation | null }>
  /** A track is played, paused, at its end, or shows another time: that in seconds. */
  play: CustomEvent<{ track: number }>
  pause: CustomEvent<{ track: number }>
  ended: CustomEvent<{ track: number }>
  timeupdate: CustomEvent<{ track: number; time: number }>
  /** Pictures for a headset or a phone, of VR or AR: `scale` is their size, of the viewport's. */
  eyes: CustomEvent<{ cameras: EyeCamera[]; width: number; height: number; scale: number; milliseconds: number }>
}

/** A camera of a settings file. */
export interface Pose {
  eye: Vector
  look: Vector
  /** The scene's up by default. */
  up?: Vector
  /** Degrees, 1 to 170. */
  fov: number
  /** Whether `fov` is that of the picture's longer side, as in supersplat-viewer, and not the vertical one. */
  longer?: boolean
}

/** A text at a place of the world. */
export interface Annotation {
  position: Vector
  /** At most 200 and 5,000 characters; shown as plain text, with its lines. */
  title?: string
  text?: string
  /** Where it is seen from; without one the camera turns to it, and comes nearer. */
  camera?: Pose
}

/** A track of the camera: cubic curves through its keys. */
export interface CameraTrack {
  name?: string
  /** What comes behind the end; 'none' by default. */
  loop?: 'none' | 'repeat' | 'pingpong'
  /** Seconds; the time of the last key by default. */
  duration?: number
  /** 0 for straight lines, 1 for the smoothest; 1 by default. */
  smoothness?: number
  /** Whether each key stays until the next. */
  step?: boolean
  longer?: boolean
  /** At least one, at most 10,000, in the order of their times, which are seconds. */
  keys: readonly (Omit<Pose, 'longer'> & { time: number })[]
}

/** A settings file. Versions 1 and 2 of supersplat-viewer's are read too. */
export interface SettingsFile
  extends Partial<Omit<Settings, 'backend' | 'fov' | 'flat' | 'up' | 'readout'>> {
  fixsplat: 1
  camera?: Pose
  /** An equirectangular picture: an address in the folder of the file or below it, or data:. */
  skybox?: string
  /** At most 200. */
  annotations?: readonly Annotation[]
  /** At most 20. */
  tracks?: readonly CameraTrack[]
  /** What begins with the scene: 'track' and 'annotation' are the first of these. */
  start?: 'camera' | 'track' | 'annotation'
}

export interface FilmOptions {
  /** From 0; the one that is chosen by default. */
  track?: number
  /** Pixels, made even; those of the picture by default. */
  width?: number
  height?: number
  /** Frames a second, 1 to 120; 30 by default. */
  rate?: number
  /** Bits a second; without it the quality is constant where the encoder has that. */
  bitrate?: number
  /** Called with the share that is done; what it throws ends the film. */
  progress?: (share: number) => void
}

/** A film as a .webm. */
export interface Film {
  blob: Blob
  /** 'MediaRecorder' where there is no WebCodecs: frames then have the times at which they were drawn. */
  codec: 'VP9' | 'VP8' | 'MediaRecorder'
  frames: number
  width: number
  height: number
}

/** <fixsplat-viewer>: attributes src, cameras, view, background (#rrggbb), budget, detail, poster, turn, backend,
    threads, noui, ui, label, wheel, keep, settings, annotation, skybox, lang, eye-height, joystick, ar. */
export class Viewer extends HTMLElement {
  readonly state: 'empty' | 'loading' | 'moving' | 'still'
  /** What draws; to set it is to set the attribute. */
  get backend(): Backend | undefined
  set backend(name: Backend | '' | null | undefined)
  /** Eye, look, up and field of view: ten numbers with commas, as the attribute `view`. Three more where not 0:
      1 for parallel rays, and how far right and down of the middle the axis lies, in heights of the picture. Empty without a scene. */
  get view(): string
  /** As to set the attribute. */
  set view(text: string | null | undefined)
  /** The address of the viewer's page with this scene and view. */
  readonly link: string
  /** The scenes on show. */
  readonly scenes: ShownScene[]
  /** A copy; null without a scene. Some of one may be set, before there is a scene too: then it begins so. An Error
      where a number is missing. */
  get camera(): ViewerCamera | null
  set camera(camera: SomeCamera | null)
  /** All; some may be set. To set an address is to set the attribute, which is that of a settings file. */
  get settings(): Settings
  set settings(values: { [Name in keyof Settings]?: Settings[Name] | null } | string)
  /** Opens an address, a file, or the files of one scene; what there was stays where that fails. */
  open(source: string | File | File[]): Promise<boolean>
  /** Puts one more scene beside those there are: a new <fixsplat-scene> in this element. */
  add(source: string | File | File[], place?: Place): PlacedScene
  /** Takes away what `src`, `open` or a person has opened; each <fixsplat-scene> of the page stays. */
  clear(): void
  /** Puts the scene of another address in the place of the one on show; the camera stays. False where there is no scene
      yet, or where it is not the time: ask again. */
  replace(source: string): Promise<boolean>
  /** Of the views of `cameras`, from 0. */
  showView(index: number): void
  /** Moves the camera in so many milliseconds, 1000 by default; at once where the machine is set to less motion. True
      when it is there, false where a hand, a program or another scene has taken the camera meanwhile. */
  flyTo(camera: SomeCamera, options?: { duration?: number }): Promise<boolean>
  /** What is at a place, in CSS pixels of the element; null where nothing is. */
  pick(x: number, y: number): Promise<Found | null>
  /** Copies; some may be set, which are there a moment later. What is wrong in one is an event `error`. */
  get annotations(): Annotation[]
  set annotations(list: readonly Annotation[])
  get tracks(): CameraTrack[]
  set tracks(list: readonly CameraTrack[])
  /** Opens the caption of an annotation, from 0, and flies to it. True when it is there. Rejects where there is none. */
  goTo(index: number): Promise<boolean>
  /** Plays a track, from 0, or the one that is chosen, from where it was paused. Rejects where there is none. */
  play(track?: number): Promise<void>
  pause(): void
  /** Shows a time of the track, seconds. */
  seek(seconds: number): void
  readonly time: number
  readonly duration: number
  readonly paused: boolean
  /** Each frame is drawn whole, as `fixsplat render` draws it, and goes to the codec, which changes its bytes. */
  film(options?: FilmOptions): Promise<Film>
  /** Reads a settings file: its address, a File, or what it says. What it gives in place of annotations, tracks and camera
      takes the place of those that are there. Lines about what of it is left out. Rejects where it is none. */
  readSettings(source: string | File | object): Promise<string[]>
  addEventListener<Name extends keyof ViewerEvents>(
    name: Name, listener: (this: Viewer, event: ViewerEvents[Name]) => void, options?: How): void
  addEventListener<Name extends keyof HTMLElementEventMap>(
    name: Name, listener: (this: Viewer, event: HTMLElementEventMap[Name]) => void, options?: How): void
  addEventListener(name: string, listener: EventListenerOrEventListenerObject, options?: How): void
}

/** The attributes as frameworks take them: `true` and '' are there, `undefined` is not. */
export interface ViewerAttributes {
  src?: string
  cameras?: string
  view?: string
  background?: string
  budget?: number | string
  detail?: number | string
  poster?: string
  backend?: Backend | ''
  threads?: number | string
  turn?: '' | true
  /** Nothing but the picture. */
  noui?: '' | true
  /** Which parts of the interface there are, and no others; all without it. */
  ui?: '' | 'annotations' | 'tracks' | 'annotations tracks'
  /** The scene's name in the corner; without it that of its file. */
  label?: string
  wheel?: 'page' | ''
  ar?: Settings['ar']
  keep?: number | string
  settings?: string
  annotation?: number | string
  skybox?: string
  lang?: string
  'eye-height'?: number | string
  joystick?: '' | 'none'
}

/** As of a cameras.json. */
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
