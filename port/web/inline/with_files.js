// The package with its files inside, for programs whose scripts alone are carried on.
import './files.js'
export * from '../fixsplat.js'
