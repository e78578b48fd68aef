// The entry module of the viewer element <fixsplat-viewer> for bundlers.
import './starts.js'
export * from './viewer.js'
