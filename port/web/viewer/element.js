// The element, as bundlers take it.
import './starts.js'
export * from './viewer.js'
