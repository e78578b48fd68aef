// The viewer element with its files embedded, for bundlers that copy only scripts.
import 'fixsplat/inline/files.js'
import './inline_worker.js'
export * from './viewer.js'
