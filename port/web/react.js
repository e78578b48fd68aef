// The element for React; its types are in react.d.ts.
export * from './viewer/element.js'
