// The package with its files embedded, for bundlers that copy only scripts.
import './files.js'
export * from '../fixsplat.js'
