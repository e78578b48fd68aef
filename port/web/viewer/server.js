// Empty classes of the elements for server-side rendering; the browser defines the real ones.
export class Viewer {}
export class PlacedScene {}
