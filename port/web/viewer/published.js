// The script of a page of `fixsplat publish`: the address of the page sets view and annotation, as its own links do.
import './viewer.js'
import { followAddress } from './views.js'

const viewer = document.querySelector('fixsplat-viewer')
viewer.linksHere = true
followAddress(viewer)
viewer.focus({ focusVisible: false })
