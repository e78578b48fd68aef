// The element where a page is made by a server, which shows nothing: the browser has it then.
export class Viewer {}
