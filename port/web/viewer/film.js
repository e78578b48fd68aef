// Makes a film of a camera track as a .webm file, frame by frame. WebCodecs encodes each frame with its time in the
// film. Without WebCodecs, MediaRecorder records each frame for its duration by the clock.

const CODECS = { 'vp09.00.51.08': 'VP9', vp8: 'VP8' }
const BITS_A_PIXEL = 0.3
const QUANTIZER = 20 // quantizer of VP9: 0 is the finest, 63 the coarsest
const FAST_BITS = 16e6 // bit rate of MediaRecorder in bits a second
const KEY_S = 2 // seconds between key frames
const MOST_WAITING = 4 // largest number of frames that wait in the queue of the encoder
const MOST_FRAMES = 36000

const pause = (ms) => new Promise((done) => setTimeout(done, ms))

// ---- WebM: RFC 9559, and RFC 8794 for its elements -----------------------------------------------------------------

function numberOf(value, length) {
  const bytes = new Uint8Array(length)
  for (let i = length - 1, rest = value; i >= 0; i--, rest = Math.floor(rest / 256)) bytes[i] = rest % 256
  return bytes
}

const idOf = (id) => numberOf(id, Math.ceil(Math.log2(id + 1) / 8))
function doubleOf(value) {
  const bytes = new DataView(new ArrayBuffer(8))
  bytes.setFloat64(0, value)
  return new Uint8Array(bytes.buffer)
}

const partOf = (value) => {
  if (typeof value === 'number') return numberOf(value, 8)
  return typeof value === 'string' ? new TextEncoder().encode(value) : value
}

function element(id, ...inside) {
  const body = inside.map(partOf).flat(Infinity)
  const size = body.reduce((sum, bytes) => sum + bytes.length, 0)
  return [idOf(id), Uint8Array.of(1, ...numberOf(size, 7)), ...body]
}

const bytesOf = (parts) => parts.reduce((sum, bytes) => sum + bytes.length, 0)

/** Groups encoded frames into clusters of a .webm file, which start at key frames. Times within a cluster must be below
    32768 ms. */
function clustersOf(chunks) {
  const clusters = []
  for (const chunk of chunks) {
    if (chunk.isKey || !clusters.length) clusters.push([])
    clusters.at(-1).push(chunk)
  }
  return clusters.map((frames) => {
    const [{ time }] = frames
    const blocks = frames.map((frame) =>
      element(0xa3, Uint8Array.of(0x81, ...numberOf(frame.time - time, 2), frame.isKey ? 0x80 : 0), frame.bytes)
    )
    return { time, parts: element(0x1f43b675, element(0xe7, time), blocks) }
  })
}

function webmOf(codec, { width, height, rate }, chunks) {
  const head = element(0x1a45dfa3, element(0x4282, 'webm'), element(0x4287, 4), element(0x4285, 2))
  const length = (1000 * chunks.length) / rate
  const by = [element(0x4d80, 'fixsplat'), element(0x5741, 'fixsplat')]
  const info = element(0x1549a966, element(0x2ad7b1, 1e6), element(0x4489, doubleOf(length)), by)
  const video = element(0xe0, element(0xb0, width), element(0xba, height))
  const track = element(0xae, element(0xd7, 1), element(0x73c5, 1), element(0x83, 1), element(0x86, `V_${codec}`),
    element(0x23e383, Math.round(1e9 / rate)), video)
  const tracks = element(0x1654ae6b, track)
  const clusters = clustersOf(chunks)
  const cue = (time, place) => element(0xbb, element(0xb3, time), element(0xb7, element(0xf7, 1), element(0xf1, place)))
  const cuesAt = (places) => element(0x1c53bb6b, clusters.map(({ time }, i) => cue(time, places[i])))
  let at = bytesOf(info) + bytesOf(tracks) + bytesOf(cuesAt(clusters.map(() => 0)))
  const places = clusters.map(({ parts }) => {
    const place = at
    at += bytesOf(parts)
    return place
  })
  const segment = element(0x18538067, info, tracks, cuesAt(places), clusters.map(({ parts }) => parts))
  return new Blob([...head, ...segment], { type: 'video/webm' })
}

// ---- Encoding by WebCodecs or MediaRecorder ------------------------------------------------------------------------

async function configOf({ width, height, rate, bitrate }) {
  const [fine, coarse] = Object.keys(CODECS)
  const by = { width, height, framerate: rate, bitrate: bitrate ?? Math.round(BITS_A_PIXEL * width * height * rate) }
  const configs = [{ codec: fine, ...by }, { codec: coarse, ...by }]
  if (!bitrate) configs.unshift({ codec: fine, width, height, framerate: rate, bitrateMode: 'quantizer' })
  for (const config of configs)
    if ((await VideoEncoder.isConfigSupported(config).catch(() => null))?.supported) return config
  return null
}

async function encoded(config, film, frames) {
  const chunks = []
  let failure
  const output = (chunk) => {
    const bytes = new Uint8Array(chunk.byteLength)
    chunk.copyTo(bytes)
    chunks.push({ bytes, time: Math.round(chunk.timestamp / 1000), isKey: chunk.type === 'key' })
  }
  const layout = { format: 'RGBX', codedWidth: film.width, codedHeight: film.height }
  const encoder = new VideoEncoder({ output, error: (error) => (failure = error) })
  try {
    encoder.configure(config)
    let i = 0
    for await (const pixels of frames) {
      const timestamp = Math.round((1e6 * i) / film.rate)
      const frame = new VideoFrame(pixels, { ...layout, timestamp })
      encoder.encode(frame, { keyFrame: i++ % Math.round(KEY_S * film.rate) === 0, vp9: { quantizer: QUANTIZER } })
      frame.close()
      while (encoder.encodeQueueSize > MOST_WAITING && !failure) await pause(5)
      if (failure) throw failure
    }
    await encoder.flush()
  } finally {
    if (encoder.state !== 'closed') encoder.close()
  }
  const codec = CODECS[config.codec]
  return { blob: webmOf(codec, film, chunks), codec, frames: chunks.length }
}

async function recorded(film, frames) {
  const canvas = Object.assign(document.createElement('canvas'), { width: film.width, height: film.height })
  const context = canvas.getContext('2d')
  const stream = canvas.captureStream(0)
  const [track] = stream.getVideoTracks()
  const recorder = new MediaRecorder(stream, { videoBitsPerSecond: film.bitrate ?? FAST_BITS, mimeType: 'video/webm' })
  const parts = []
  recorder.ondataavailable = ({ data }) => parts.push(data)
  const stopped = new Promise((done) => (recorder.onstop = done))
  let count = 0
  try {
    for await (const pixels of frames) {
      context.putImageData(new ImageData(pixels, film.width), 0, 0)
      if (count++) recorder.resume()
      else recorder.start()
      ;(track.requestFrame ? track : stream).requestFrame()
      await pause(1000 / film.rate)
      recorder.pause()
    }
  } finally {
    if (recorder.state !== 'inactive') recorder.stop()
    else recorder.onstop()
    track.stop()
  }
  await stopped
  return { blob: new Blob(parts, { type: 'video/webm' }), codec: 'MediaRecorder', frames: count }
}

// Makes a film, and returns { blob, codec, frames, width, height }. draw(seconds, width, height) returns the pixels of
// a frame. progress(share) may throw to cancel the film.
export async function filmOf(asked, draw, progress) {
  const even = (n) => Math.max(2 * Math.round(n / 2), 2)
  const { rate = 30, seconds } = asked
  const [width, height] = [even(asked.width), even(asked.height)]
  const count = Math.max(Math.round(seconds * rate), 1)
  if (!(rate >= 1 && rate <= 120)) throw new Error(`rate ${rate}: expected 1 to 120 frames a second`)
  if (!(count <= MOST_FRAMES)) throw new Error(`A film of ${count} frames: at most ${MOST_FRAMES}`)
  const film = { width, height, rate, bitrate: asked.bitrate }
  const frames = (async function* () {
    for (let i = 0; i < count; i++) {
      progress(i / count)
      yield await draw(i / rate, width, height)
    }
  })()
  const config = globalThis.VideoEncoder && (await configOf(film))
  if (!config && !globalThis.MediaRecorder) throw new Error('This browser cannot make films')
  const made = config ? await encoded(config, film, frames) : await recorded(film, frames)
  return { ...made, width, height }
}
