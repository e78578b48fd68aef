// The element for React, whose types are beside.
export * from './viewer/element.js'
