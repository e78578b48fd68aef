// TypeScript must report the marked errors, and no others.
import { load, png, render, renderStereo, Screen, setAssets } from 'fixsplat'
import * as inline from 'fixsplat/inline'
import { type Backend, Viewer, type ViewerEvents } from 'fixsplat-viewer'
import 'fixsplat-viewer/inline'
import 'fixsplat-viewer/react'
import { useRef } from 'react'

export async function pictures() {
  setAssets(new URL('https://example.org/fixsplat/'))
  const scene = await load('scene.fxs', { threads: 2, preview: (part) => part.free() })
  const size = { width: 4, height: 4 }
  new ImageData(scene.render({}, size), 4)
  new ImageData(render([{ scene }], {}, size), 4)
  for (const pixels of renderStereo([{ scene }], {}, {}, size)) new ImageData(pixels, 4)
  new Blob([await png(scene.render({}, size), 4, 4), scene.packed])
  await inline.load(new Response().body ? 'scene.fxs' : new Uint8Array(4))
  const screen = await Screen.open(null, 'webgpu')
  screen.device.createBuffer({ size: 4, usage: GPUBufferUsage.STORAGE })
  const drawn = await Screen.open(document.createElement('canvas'), 'webgl2')
  // @ts-expect-error: there is none where WebGL draws
  drawn.device.queue
  // @ts-expect-error: no back end
  await Screen.open(null, 'metal')
  // @ts-expect-error: three numbers
  scene.render({ eye: [0, 1] })
}

export function page() {
  const viewer = document.querySelector('fixsplat-viewer')
  viewer?.addEventListener('frame', ({ detail }) => console.log(detail.milliseconds.toFixed()))
  viewer?.addEventListener('error', (event) => console.log(event.message.length))
  const shown = ({ detail }: ViewerEvents['frame']) => console.log(detail.milliseconds.toFixed())
  viewer?.addEventListener('frame', shown)
  viewer?.removeEventListener('frame', shown)
  const made: Viewer = document.createElement('fixsplat-viewer')
  made.settings = { mode: 'walk', eyeHeight: 1.6 }
  made.view = '0,0,-4,0,0,0,0,-1,0,45'
  const backend: Backend | undefined = made.backend
  // @ts-expect-error: of the element, not of the program
  made.link = ''
  return backend
}

export function Component({ src }: { src: string }) {
  const viewer = useRef<Viewer>(null)
  return (
    <>
      <fixsplat-viewer ref={viewer} key="a" src={src} budget={5e5} turn="" noui backend="webgl2" className="a" />
      <fixsplat-viewer eye-height={1.6} joystick="none" />
      <fixsplat-viewer onPointerDown={(event) => event.currentTarget.replace(src)} suppressHydrationWarning />
      <fixsplat-viewer settings="settings.json" ui="annotations" label="A" annotation={1} skybox="sky.jpg" lang="de" />
      <fixsplat-viewer onframe={({ detail }) => console.log(detail.milliseconds.toFixed())} onload={undefined} />
      {/* @ts-expect-error: not the event's type */}
      <fixsplat-viewer oncamera={(event: ErrorEvent) => console.log(event)} />
      {/* @ts-expect-error: no part of the interface */}
      <fixsplat-viewer ui="everything" />
      {/* @ts-expect-error: an address */}
      <fixsplat-viewer src={5} />
      {/* @ts-expect-error: no such attribute */}
      <fixsplat-viewer colour="red" />
    </>
  )
}
