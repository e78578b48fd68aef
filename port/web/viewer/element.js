// The entry of the element for bundlers.
import './starts.js'
export * from './viewer.js'
