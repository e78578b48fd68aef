export type Backend = 'wasm' | 'webgl2' | 'webgl2-quads' | 'webgpu'

/** <fixsplat-viewer>: attributes src, cameras, view, background (#rrggbb), budget, detail, poster, turn, backend,
    threads, noui. */
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
  /** Opens an address, a file, or the files of a scene; what there was stays where that fails. */
  open(source: string | File | File[]): Promise<boolean>
  /** Puts the scene of another address in the place of the one on show; the camera stays. False where there is no scene
      yet, or where it is not the time: ask again. */
  replace(source: string): Promise<boolean>
  /** Of the views of `cameras`, from 0. */
  showView(index: number): void
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
  noui?: '' | true
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
  }
  interface HTMLElementEventMap {
    /** Pictures for a headset: `scale` is their size, of the viewport's. */
    eyes: CustomEvent<{ cameras: EyeCamera[]; width: number; height: number; scale: number; milliseconds: number }>
    /** `drawn` Gaussians, with `missing` parts that are still to come. */
    picture: CustomEvent<{
      width: number; height: number; divisor: number; milliseconds: number; backend: Backend
      drawn: number; missing: number
    }>
  }
}
