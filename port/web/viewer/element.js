// The entry of the viewer element for bundlers.
import './starts.js'
export * from './viewer.js'
