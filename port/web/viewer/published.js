// The page that `fixsplat publish` writes. The page's address sets the view and the annotation.
import './viewer.js'
import { followAddress } from './views.js'

const viewer = document.querySelector('fixsplat-viewer')
viewer.linksHere = true
followAddress(viewer)
viewer.focus({ focusVisible: false })
