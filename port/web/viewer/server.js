// The elements where a page is made by a server, which shows nothing: the browser has them then.
export class Viewer {}
export class PlacedScene {}
