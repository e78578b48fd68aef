// The viewer element for React.
export * from './element.js'
