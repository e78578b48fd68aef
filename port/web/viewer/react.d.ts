import type { ClassAttributes, HTMLAttributes } from 'react'
import type { Place, PlacedScene, Viewer, ViewerAttributes, ViewerHandlers } from './viewer.js'

export * from './viewer.js'

type ViewerProps = ClassAttributes<Viewer> & HTMLAttributes<Viewer> & ViewerAttributes & ViewerHandlers &
  { class?: string }
type SceneProps = ClassAttributes<PlacedScene> & Omit<HTMLAttributes<PlacedScene>, keyof Place> & Place &
  { src?: string; class?: string }

// The types of the viewer's elements in JSX: for React 19 and React 18.2.6 or later, then as global types for earlier
// React 18.
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
