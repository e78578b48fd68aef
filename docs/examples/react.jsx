// The element in React 18 and 19: it comes and goes with a component, and its attributes follow the component's state.
// TypeScript knows it by the same import.
import 'fixsplat-viewer/react'
import { useEffect, useRef, useState } from 'react'

const VIEW = '0.3,-0.9,-4,0,0,0,0,-1,0'

/** A scene; `onPicture` is told of each picture, `onFault` why there is none. */
export function Splats({ src, view, onPicture, onFault }) {
  const viewer = useRef(null)
  useEffect(() => {
    const element = viewer.current
    const drawn = (event) => onPicture?.(event.detail)
    const failed = (event) => onFault?.(event.message)
    element.addEventListener('frame', drawn)
    element.addEventListener('error', failed)
    return () => {
      element.removeEventListener('frame', drawn)
      element.removeEventListener('error', failed)
    }
  }, [onPicture, onFault])
  const style = { width: 320, height: 200 }
  // The element has attributes of its own (`state`), which may be there before React takes over what a server has made.
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
