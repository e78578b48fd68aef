import type { ClassAttributes, HTMLAttributes } from 'react'
import type { Viewer, ViewerAttributes } from './viewer/viewer.js'

export * from './viewer/viewer.js'

type ViewerProps = ClassAttributes<Viewer> & HTMLAttributes<Viewer> & ViewerAttributes & { class?: string }

// JSX of React from 18.2.6 on, and 19; then that of React 18 before, which is the same for all of a program.
declare module 'react' {
  namespace JSX {
    interface IntrinsicElements {
      'fixsplat-viewer': ViewerProps
    }
  }
}

declare global {
  namespace JSX {
    interface IntrinsicElements {
      'fixsplat-viewer': ViewerProps
    }
  }
}
