import type { ClassAttributes, HTMLAttributes } from 'react'
import type { Place, PlacedScene, Viewer, ViewerAttributes } from './viewer/viewer.js'

export * from './viewer/viewer.js'

type ViewerProps = ClassAttributes<Viewer> & HTMLAttributes<Viewer> & ViewerAttributes & { class?: string }
type SceneProps = ClassAttributes<PlacedScene> & Omit<HTMLAttributes<PlacedScene>, keyof Place> & Place &
  { src?: string; class?: string }

// JSX of React from 18.2.6 on, and 19; then that of React 18 before, which is the same for all of a program.
declare module 'react' {
  namespace JSX {
    interface IntrinsicElements {
      'fixsplat-viewer': ViewerProps
      'fixsplat-scene': SceneProps
    }
  }
}

declare global {
  namespace JSX {
    interface IntrinsicElements {
      'fixsplat-viewer': ViewerProps
      'fixsplat-scene': SceneProps
    }
  }
}
