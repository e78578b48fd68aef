/** <fixsplat-viewer>: attributes src, cameras, view, background (#rrggbb) and noui. */
export class Viewer extends HTMLElement {
  readonly state: 'empty' | 'loading' | 'moving' | 'still'
  /** Eye, look, up and field of view: ten numbers with commas, as the attribute `view`. */
  readonly view: string
  /** The address of the viewer's page with this scene and view. */
  readonly link: string
  /** Opens an address or a file; what there was stays where that fails. */
  open(source: string | File): Promise<boolean>
  /** Of the views of `cameras`, from 0. */
  showView(index: number): void
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
    picture: CustomEvent<{ width: number; height: number; divisor: number; milliseconds: number }>
  }
}
