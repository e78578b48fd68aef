// Reads and writes settings files of the viewer. Reads settings files of supersplat-viewer too, versions 1 and 2. A
// faulty part is left out and reported by a line of text. A camera is { eye, look, up, fov, longer }. With `longer`,
// fov is the field of view of the longer side of the picture.
import { CURVES } from './look.js'
import { LOOPS } from './track.js'
import { hasNumbers } from './views.js'

const MOST_ANNOTATIONS = 200
const MOST_TRACKS = 20
const MOST_KEYS = 10000
const MOST_TITLE = 200
const MOST_TEXT = 5000
export const MOST_SECONDS = 86400
const MOST_WORDS = 5
const FAR = 1e9
const NUMBERS = [['budget', 0, FAR], ['detail', 0, 16384], ['speed', 0.01, 10], ['sharpness', 0.1, 1],
  ['eyeHeight', 0, FAR], ['exposure', -8, 8], ['vignette', 0, 1]]
const SIZES = ['table', 'true', 'off']
const MODES = ['orbit', 'fly', 'walk']
const STARTS = ['camera', 'track', 'annotation']

const isObject = (value) => typeof value === 'object' && value !== null && !Array.isArray(value)
const isNumber = (x, low = -FAR, high = FAR) => typeof x === 'number' && x >= low && x <= high
const isVector = (v) => hasNumbers(v, 3) && v.every((x) => isNumber(x))

function need(is, words) {
  if (!is) throw new Error(words)
}

function vectorOf(value, name) {
  need(isVector(value), `${name}: expected three numbers`)
  return [...value]
}

function textOf(value, name, most) {
  need(value === undefined || typeof value === 'string', `${name}: expected a text`)
  return (value ?? '').slice(0, most)
}

function listOf(value, name, most, words) {
  if (value === undefined) return []
  need(Array.isArray(value), `${name}: expected a list`)
  if (value.length > most) words.push(`${name}: ${value.length} of them: the first ${most} are shown`)
  return value.slice(0, most)
}

export function poseOf(value, name = 'camera') {
  need(isObject(value), `${name}: expected an object`)
  const { up, fov, longer } = value
  const pose = { eye: vectorOf(value.eye, `${name}.eye`), look: vectorOf(value.look, `${name}.look`) }
  const ahead = pose.eye.map((x, i) => x - pose.look[i])
  need(Math.hypot(...ahead) > 0, `${name}: looks nowhere, as eye and look are the same`)
  need(isNumber(fov, 1, 170), `${name}.fov: expected 1 to 170 degrees`)
  if (up !== undefined) pose.up = vectorOf(up, `${name}.up`)
  need(!pose.up || Math.hypot(...pose.up) > 0, `${name}.up: expected a direction`)
  return { ...pose, fov, ...(longer === true && { longer }) }
}

function annotationOf(value, name) {
  need(isObject(value), `${name}: expected an object`)
  const { camera } = value
  const told = { position: vectorOf(value.position, `${name}.position`) }
  told.title = textOf(value.title, `${name}.title`, MOST_TITLE)
  told.text = textOf(value.text, `${name}.text`, MOST_TEXT)
  return camera === undefined ? told : { ...told, camera: poseOf(camera, `${name}.camera`) }
}

function trackOf(value, name) {
  need(isObject(value) && Array.isArray(value.keys), `${name}.keys: expected a list`)
  const { loop = 'none', smoothness = 1, step = false, longer, keys } = value
  need(keys.length > 0, `${name}: it has no key`)
  need(keys.length <= MOST_KEYS, `${name}: more than ${MOST_KEYS} keys`)
  need(LOOPS.includes(loop), `${name}.loop: expected one of ${LOOPS.join(', ')}`)
  need(isNumber(smoothness, 0, 1), `${name}.smoothness: expected 0 to 1`)
  const taken = keys.map((key, i) => {
    const pose = poseOf(key, `${name}, key ${i + 1}`)
    need(isNumber(key.time, 0, MOST_SECONDS), `${name}, key ${i + 1}: expected a time in seconds`)
    need(!i || key.time > keys[i - 1].time, `${name}, key ${i + 1}: its time is not behind that of the key before`)
    return { time: key.time, eye: pose.eye, look: pose.look, ...(pose.up && { up: pose.up }), fov: pose.fov }
  })
  const { duration = taken.at(-1).time || 1 } = value
  need(isNumber(duration, 1e-3, MOST_SECONDS), `${name}.duration: expected seconds`)
  const how = { name: textOf(value.name, `${name}.name`, MOST_TITLE), loop, duration, smoothness, step: step === true }
  return { ...how, ...(longer === true && { longer }), keys: taken }
}

// ---- Files of supersplat-viewer ------------------------------------------------------------------------------------

/** Converts a vector of a settings file of supersplat-viewer, which turns scenes by half a turn about z. */
const turned = (v) => (isVector(v) ? [-v[0], -v[1], v[2]] : v)
const UP = [0, -1, 0]

function poseOfTheirs({ position, target, fov } = {}) {
  return { eye: turned(position), look: turned(target), up: UP, fov, longer: true }
}

const rowsOf = (list, i) => (Array.isArray(list) ? list.slice(3 * i, 3 * i + 3) : undefined)

/** Converts a camera track of supersplat-viewer. Its times are in frames, or in seconds in early files without a frame
    rate. */
function trackOfTheirs(track, fov) {
  if (!isObject(track)) return track
  const { name, duration, frameRate, loopMode, interpolation, smoothness, keyframes } = track
  const { times, values } = keyframes ?? {}
  const { position, target, fov: fovs } = values ?? {}
  const keys = Array.isArray(times) && times.map((time, i) => {
    const pose = { position: rowsOf(position, i), target: rowsOf(target, i), fov: fovs === undefined ? fov : fovs?.[i] }
    return { ...poseOfTheirs(pose), time: typeof time === 'number' ? time / (frameRate || 1) : time }
  })
  const step = interpolation === 'step'
  return { name, duration, loop: loopMode, smoothness: smoothness ?? 0, step, longer: true, keys }
}

function annotationOfTheirs(annotation) {
  if (!isObject(annotation)) return annotation
  const { position, title, text, camera } = annotation
  const pose = camera?.initial ? poseOfTheirs(camera.initial) : undefined
  return { position: turned(position), title, text, camera: pose }
}

const COLOUR = [0, 0, 0]
const byte = (x) => Math.round(255 * Math.min(Math.max(x, 0), 1)).toString(16).padStart(2, '0')
const hex = (colour) => (isVector(colour) ? `#${colour.map(byte).join('')}` : colour)

const eachOf = (list, of) => (Array.isArray(list) ? list.map(of) : list)

const hasCurve = (name) => Object.hasOwn(CURVES, name)

function sayLeftOut({ postEffectSettings, soundUrl, tonemapping }, words) {
  const effects = Object.entries(isObject(postEffectSettings) ? postEffectSettings : {})
  const names = effects.filter(([name, effect]) => effect?.enabled && name !== 'vignette').map(([name]) => name)
  if (names.length) words.push(`postEffectSettings: ${names.join(', ')}: not drawn here`)
  if (![undefined, 'none', ...Object.keys(CURVES)].includes(tonemapping))
    words.push(`tonemapping: ${tonemapping}: not drawn here`)
  if (soundUrl) words.push('soundUrl: no sound is played here')
}

function fromTheirs(file, words) {
  const { version, cameras, background, animTracks, annotations, startMode } = file
  need(version === undefined || version === 2, `version ${version}: expected 1 or 2 of supersplat-viewer, or our own`)
  if (version === 2) sayLeftOut(file, words)
  const { camera = {} } = version === 2 ? {} : file
  const fov = camera?.fov || 85
  const first = version === 2 ? cameras?.[0]?.initial : camera?.position && camera?.target && { ...camera, fov }
  const start = version === 2 ? startMode : camera?.startAnim
  return {
    camera: first ? poseOfTheirs(first) : undefined,
    background: background && hex(background.color ?? COLOUR),
    skybox: background?.skyboxUrl,
    tracks: eachOf(animTracks, (track) => trackOfTheirs(track, fov)),
    annotations: eachOf(annotations, annotationOfTheirs),
    start: { animTrack: 'track', annotation: 'annotation' }[start],
    turn: start === 'orbit' || undefined,
    tone: hasCurve(file.tonemapping) ? file.tonemapping : undefined,
    vignette: file.postEffectSettings?.vignette?.enabled ? file.postEffectSettings.vignette.intensity : undefined,
  }
}

// ---- Settings files ------------------------------------------------------------------------------------------------

function checked(file, words) {
  const settings = {}
  const take = (name, read) => {
    try {
      if (file[name] !== undefined && file[name] !== null) settings[name] = read(file[name])
    } catch (error) {
      words.push(`${error.message}: left out`)
    }
  }
  const each = (name, most, read) =>
    take(name, (list) =>
      listOf(list, name, most, words).flatMap((value, i) => {
        try {
          return [read(value, `${name} ${i + 1}`)]
        } catch (error) {
          words.push(`${error.message}: left out`)
          return []
        }
      })
    )
  const number = (name, low, high) => (x) => (need(isNumber(x, low, high), `${name}: expected ${low} to ${high}`), x)
  take('camera', (camera) => poseOf(camera))
  take('background', (colour) => (need(/^#[0-9a-f]{6}$/i.test(colour), 'background: expected #rrggbb'), colour))
  take('skybox', (url) => (need(typeof url === 'string', 'skybox: expected an address'), url))
  take('start', (start) => (need(STARTS.includes(start), `start: expected one of ${STARTS.join(', ')}`), start))
  take('ar', (size) => (need(SIZES.includes(size), `ar: expected one of ${SIZES.join(', ')}`), size))
  take('tone', (tone) => (need(hasCurve(tone), `tone: expected one of ${Object.keys(CURVES).join(', ')}`), tone))
  take('mode', (mode) => (need(MODES.includes(mode), `mode: expected one of ${MODES.join(', ')}`), mode))
  for (const name of ['turn', 'colours']) take(name, (is) => is === true)
  for (const [name, low, high] of NUMBERS) take(name, number(name, low, high))
  each('annotations', MOST_ANNOTATIONS, annotationOf)
  each('tracks', MOST_TRACKS, trackOf)
  return settings
}

export function settingsOf(name, text) {
  let file
  try {
    file = JSON.parse(text)
  } catch {
    throw new Error(`${name}: this is no settings file: it is not JSON`)
  }
  need(isObject(file), `${name}: this is no settings file: expected an object`)
  const words = []
  try {
    const settings = checked(file.fixsplat === undefined ? fromTheirs(file, words) : file, words)
    return { settings, words: shortened(words).map((line) => `${name}: ${line}`) }
  } catch (error) {
    throw new Error(`${name}: ${error.message}`)
  }
}

function shortened(words) {
  const more = words.length - MOST_WORDS
  return more > 0 ? [...words.slice(0, MOST_WORDS), `and ${more} more of the kind`] : words
}

export function listsOf(given) {
  const words = []
  const settings = checked(given, words)
  need(!words.length, words[0])
  return settings
}

export const textOfSettings = (settings) => `${JSON.stringify({ fixsplat: 1, ...settings }, null, 2)}\n`
