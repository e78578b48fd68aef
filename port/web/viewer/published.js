// The script of a page that `fixsplat publish` wrote: it follows the links that it gives.
import './viewer.js'
import { followAddress } from './views.js'

const viewer = document.querySelector('fixsplat-viewer')
viewer.linksHere = true
followAddress(viewer)
viewer.focus({ focusVisible: false })
