// Empty classes of <fixsplat-viewer> and <fixsplat-scene> for server-side rendering. The browser defines the real
// classes.
export class Viewer {}
export class PlacedScene {}
