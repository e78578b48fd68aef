// Splats in react-three-fiber: <SplatScene src="scene.fxs" position={[0, 1, 0]} /> inside a <Canvas>.
import { type ThreeElements, useThree } from '@react-three/fiber'
import { Splats } from 'fixsplat-viewer/three'
import { useEffect, useState } from 'react'

type Props = Omit<ThreeElements['primitive'], 'object'> & {
  src: string
  /** Receives the reason if the scene cannot be loaded. */
  onFault?: (error: Error) => void
}

export function SplatScene({ src, onFault, ...place }: Props) {
  const { gl, invalidate } = useThree()
  const [splats, setSplats] = useState<Splats | null>(null)
  useEffect(() => {
    const ending = new AbortController()
    const loading = Splats.load(gl, src, { signal: ending.signal }).then((loaded) => {
      if (ending.signal.aborted) return loaded.dispose()
      ending.signal.addEventListener('abort', () => loaded.dispose())
      loaded.addEventListener('change', () => invalidate())
      setSplats(loaded)
    })
    loading.catch((error: Error) => ending.signal.aborted || onFault?.(error))
    return () => {
      ending.abort()
      setSplats(null)
    }
  }, [gl, src])
  return splats && <primitive {...place} object={splats} />
}
