// The element in React 18 and 19: it comes and goes with a component, and its attributes follow the component's state.
// The first import also brings the types of the element to JSX.
import 'fixsplat-viewer/react'
import type { Viewer, ViewerEvents } from 'fixsplat-viewer'
import { useEffect, useRef, useState } from 'react'

const VIEW = '0.3,-0.9,-4,0,0,0,0,-1,0'

interface Props {
  src: string
  view: string
  /** Receives the facts of each picture. */
  onPicture?: (facts: ViewerEvents['frame']['detail']) => void
  /** Receives the reason if the scene cannot be shown. */
  onFault?: (words: string) => void
}

export function Splats({ src, view, onPicture, onFault }: Props) {
  const viewer = useRef<Viewer>(null)
  useEffect(() => {
    const element = viewer.current
    if (!element) return
    const drawn = (event: ViewerEvents['frame']) => onPicture?.(event.detail)
    const failed = (event: ErrorEvent) => onFault?.(event.message)
    element.addEventListener('frame', drawn)
    element.addEventListener('error', failed)
    return () => {
      element.removeEventListener('frame', drawn)
      element.removeEventListener('error', failed)
    }
  }, [onPicture, onFault])
  const style = { width: 320, height: 200 }
  // The element has attributes of its own (`state`), which may be there before React takes over what a server has made.
  // React 19 also takes events as properties: onframe={drawn} onerror={failed}.
  return <fixsplat-viewer suppressHydrationWarning ref={viewer} src={src} view={view} noui="" style={style} />
}

export default function App() {
  const [shown, setShown] = useState(true)
  const [fov, setFov] = useState(45)
  const [words, setWords] = useState('')
  return (
    <>
      {shown && <Splats src="/scene.ply" view={`${VIEW},${fov}`} onFault={setWords} />}
      <button id="wider" onClick={() => setFov(60)}>Wider</button>
      <button id="shown" onClick={() => setShown(!shown)}>{shown ? 'Away' : 'Back'}</button>
      <p>{words}</p>
    </>
  )
}
