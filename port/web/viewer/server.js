// Empty classes of the elements for server-side rendering. The browser defines the real classes.
export class Viewer {}
export class PlacedScene {}
