// The viewer element for React.
export * from './viewer/element.js'
