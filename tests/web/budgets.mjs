// node budgets.mjs PART FIXSPLAT SCENES MODULES FOLDER [SCENE...]: measures scenes with levels of detail, and prints a
// table. FIXSPLAT is the command-line program, MODULES a node_modules folder. FOLDER keeps converted scenes. PART is:
// cuts: compares fixsplat's pictures with a limited number of Gaussians to other programs' pictures with as many.
// budgets: PSNR, time and bytes of frames for falling limits of the number of Gaussians.
// steps: visible changes from frame to frame, in FRAMES (240) frames along a slow camera path.
// boards: number of Gaussians that an emulated microcontroller board draws in a tenth of a second.
import { execFileSync, spawnSync } from 'node:child_process'
import {
    closeSync, existsSync, mkdirSync, openSync, readFileSync, readSync, renameSync, rmSync, statSync, writeFileSync,
} from 'node:fs'

const [part, fixsplat, scenes, modules, folder, ...asked] = process.argv.slice(2)
const { ROUNDS = 5, FRAMES = 240, LANDSCAPE = 10000000 } = process.env
const run = (program, ...words) =>
    execFileSync(program, words.flat(Infinity).map(String), { encoding: 'utf8', maxBuffer: 1 << 30 })
const mean = values => values.reduce((sum, x) => sum + x, 0) / values.length
const median = values => values.sort((a, b) => a - b)[values.length >> 1]
const isAsked = name => !asked.length || asked.includes(name)
const say = (...lines) => console.log(`${lines.join('\n')}\n`)
const row = (...cells) => console.log(`| ${cells.join(' | ')} |`)
const head = (...cells) => { row(...cells); console.log(`|${cells.map(() => '---|').join('')}`) }
mkdirSync(folder, { recursive: true })

const kept = (name, make) => {
    const path = `${folder}/${name}`, unfinished = `${folder}/unfinished-${name}`
    if (!existsSync(path)) {
        make(unfinished)
        renameSync(unfinished, path)
    }
    return path
}
const convert = (from, name, ...words) => kept(name, to => run(fixsplat, 'convert', from, to, words))

const SCENES = {
    snowmiku: { file: 'snowmiku/snowmiku.ply', cameras: 'snowmiku/cameras.json', timed: 1 },
    'luma-seal': { file: 'luma-seal/luma-seal.ply', up: [0, -1, 0] },
    'boatyard-tile3': { file: 'boatyard-tile3/boatyard-tile3.ply', up: [0, 0, 1] },
    skull: { file: 'skull/skull.sog', up: [0, -1, 0] },
    landscape: { made: LANDSCAPE, size: '1920x1080' },
    captured: { up: [0, -1, 0], beside: ['snowmiku/snowmiku.ply', 'kitchen-marble/kitchen-marble.ply',
        'statue-st-peter/st-peter.ply', 'luma-seal/luma-seal.ply', 'guitar/guitar.ply',
        'boatyard-tile3/boatyard-tile3.ply', 'skull/skull.sog'] },
}
const [WIDTH, HEIGHT, VIEWS, EIGHTH] = [960, 640, 9, 8]
const COMPARED = ['snowmiku', 'luma-seal', 'boatyard-tile3']

const dot = (a, b) => a.reduce((sum, x, k) => sum + x * b[k], 0)
const cross = (a, b) => [0, 1, 2].map(k => a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3])
const unit = v => v.map(x => x / Math.hypot(...v))

const around = ({ seen: [low, high] }, up) => {
    const half = low.map((x, k) => (high[k] - x) / 2), middle = low.map((x, k) => x + half[k])
    const first = unit(Math.abs(up[2]) > 0.9 ? [0, -1, 0] : [0, 0, -1]), side = cross(up, first)
    const focal = HEIGHT / 2 / Math.tan(25 * Math.PI / 180)
    return Array.from({ length: VIEWS }, (_, i) => {
        const [s, c] = [Math.sin, Math.cos].map(f => f(2 * Math.PI * i / VIEWS))
        const ahead = unit(first.map((x, k) => -0.95 * (c * x + s * side[k]) - 0.31 * up[k]))
        const right = unit(cross(ahead, up)), down = cross(ahead, right)
        const reach = axis => half.reduce((sum, h, k) => sum + h * Math.abs(axis[k]), 0)
        const away = Math.max(reach(right) / WIDTH, reach(down) / HEIGHT) * 2 * focal / 0.95 + reach(ahead)
        const distance = away * [1, 0.35, 2][i % 3]
        const rotation = [0, 1, 2].map(k => [right[k], down[k], ahead[k]])
        return { id: i, img_name: `${i}`, width: WIDTH, height: HEIGHT, fx: focal, fy: focal, rotation,
            position: middle.map((m, k) => m - distance * ahead[k]) }
    })
}

const sideBySide = (files, to) => {
    const { up } = SCENES['boatyard-tile3'], parts = files.map((file, i) => {
        const [turned, part] = ['turned', 'part'].map(name => `${folder}/${name}-${i}.ply`)
        run(fixsplat, 'convert', `${scenes}/${file}`, turned, file.startsWith('boatyard') ? ['--up', up.join(',')] : [])
        const { seen: [low, high] } = JSON.parse(run(fixsplat, 'info', turned, '--json'))
        const scale = 2 / Math.max(...low.map((x, k) => high[k] - x)), place = [2 * (i % 3), 0, 2 * Math.floor(i / 3)]
        const move = place.map((x, k) => x - scale * (low[k] + high[k]) / 2)
        run(fixsplat, 'convert', turned, part, '--scale', scale, `--translate=${move.join(',')}`)
        rmSync(turned)
        return part
    })
    run(fixsplat, 'convert', parts, to)
    parts.forEach(part => rmSync(part))
}

const open = name => {
    const { file, made, beside, cameras, up, size = `${WIDTH}x${HEIGHT}`, timed = 0 } = SCENES[name]
    const source = made ? kept(`${name}.ply`, to => run(fixsplat, 'make-scene', name, '--count', made, '-o', to))
        : beside ? kept(`${name}.ply`, to => sideBySide(beside, to)) : `${scenes}/${file}`
    const levels = convert(source, `${name}.fxs`, '--levels'), info = JSON.parse(run(fixsplat, 'info', levels, '--json'))
    const given = cameras && JSON.parse(readFileSync(`${scenes}/${cameras}`))
    const scene = { name, source, levels, info, given, count: info.packed, timed: [], options: ['--size', size] }
    if (made) return scene
    const views = given ? given.filter((_, i) => i % EIGHTH === 0) : around(info, up)
    const seen = kept(`${name}-seen.json`, to => writeFileSync(to, JSON.stringify(views)))
    const half = info.seen[0].map((x, k) => (info.seen[1][k] - x) / 2)
    scene.options.push('--cameras', seen, '--near', given ? 0.2 : Math.min(Math.hypot(...half) / 100, 0.2))
    return { ...scene, views, timed: ['--view', timed] }
}

const refined = (scene, own = scene.given) => kept(`${scene.name}-refined${scene.given && !own ? '-around' : ''}.fxs`, to => {
    const others = `${folder}/others.json`
    if (own) writeFileSync(others, JSON.stringify(own.filter((_, i) => i % EIGHTH !== 0)))
    run(fixsplat, 'convert', scene.source, to, '--levels', '--refine', own ? ['--cameras', others] : [])
})

const squares = (a, b, from = 0, to = a.length) => {
    let sum = 0
    for (let i = from; i < to; i++) sum += (i & 3) === 3 ? 0 : (a[i] - b[i]) ** 2
    return sum
}
const psnr = (a, b) => 10 * Math.log10(255 ** 2 * a.length / 4 * 3 / squares(a, b))

const pictures = (scene, file, words = [], view = 'all') => {
    const film = `${folder}/film.rgba`, chosen = scene.views ? ['--view', view] : []
    const said = run(fixsplat, 'render', file, scene.options, chosen, words, '-o', film, '--stats', '--quiet')
    const stats = said.trim().split('\n').map(JSON.parse), all = readFileSync(film), bytes = all.length / stats.length
    rmSync(film)
    return { stats, frames: stats.map((_, i) => all.subarray(i * bytes, (i + 1) * bytes)) }
}

const round = x => x.toFixed(1)
const summary = values => ({ mean: mean(values), worst: Math.min(...values) })
const both = ({ mean, worst }) => Number.isFinite(mean) ? `${round(mean)} (${round(worst)})` : 'equal'
const against = (whole, frames) => summary(frames.map((frame, i) => psnr(frame, whole.frames[i])))

const transform = (scene, mode, count) => kept(`${scene.name}${mode}-${count}.ply`, to =>
    run('node', `${modules}/splat-transform-3/bin/cli.mjs`, '-q', '-w', '-g', 'cpu', scene.source, mode, count, to))

const pruned = (scene, count) => kept(`${scene.name}-pruned-${count}.ply`, to => {
    const bytes = readFileSync(scene.source), end = bytes.indexOf('end_header\n') + 11
    const text = bytes.toString('latin1', 0, end)
    const names = [...text.matchAll(/property float (\S+)/g)].map(found => found[1])
    const values = new Float32Array(bytes.buffer.slice(bytes.byteOffset + end)), at = name => names.indexOf(name)
    const weight = i => {
        const [x, y, z] = ['scale_0', 'scale_1', 'scale_2'].map(name => Math.exp(values[i + at(name)]))
        return (x * y + y * z + z * x) / (1 + Math.exp(-values[i + at('opacity')]))
    }
    const rows = Array.from({ length: values.length / names.length }, (_, i) => i * names.length)
    const weights = new Map(rows.map(i => [i, weight(i)]))
    const largest = rows.sort((a, b) => weights.get(b) - weights.get(a)).slice(0, count).sort((a, b) => a - b)
    writeFileSync(to, Buffer.concat([Buffer.from(text.replace(/element vertex \d+/, `element vertex ${count}`), 'latin1'),
        ...largest.map(i => Buffer.from(values.buffer, 4 * i, 4 * names.length))]))
})

const spark = (scene, count) => {
    const files = scene.views.map((_, i) => `${folder}/spark-${i}.ply`)
    run('node', 'tests/web/spark.mjs', modules, 'cut', scene.source, scene.views.flatMap(({ position, rotation }, i) =>
        [count, [position, ...[0, 1, 2].map(k => rotation.map(r => r[k]))].flat().join(','), files[i]]))
    return files.flatMap((file, i) => {
        const packed = file.replace('.ply', '.fxs')
        run(fixsplat, 'convert', file, packed, '--quiet')
        const { frames } = pictures(scene, packed, [], i)
        rmSync(file)
        rmSync(packed)
        return frames
    })
}

const SHARES = [0.5, 0.25, 0.1, 0.03]

const cuts = () => {
    say(`PSNR against the whole, dB, mean (worst) of ${WIDTH}x${HEIGHT} views: of snowmiku every eighth of its cameras,`,
        `which --refine did not have; of the others ${VIEWS} around them. All as .fxs of the profile default.`)
    head('scene, what is drawn', ...SHARES.map(share => `${100 * share} %`))
    for (const name of COMPARED.filter(isAsked)) {
        const scene = open(name), whole = pictures(scene, scene.levels)
        const counts = SHARES.map(share => Math.round(share * scene.count))
        const packed = path => convert(path, `${path.slice(folder.length + 1, -4)}.fxs`)
        const line = (what, frames) => {
            const found = counts.map(count => against(whole, frames(count)))
            row(`${name}, ${what}`, ...found.map(both))
            return found
        }
        const [uniform, adaptive] = [['uniform', '--decimate'], ['adaptive', '--decimate-adaptive']].map(([words, mode]) =>
            line(`splat-transform, ${words}`, n => pictures(scene, packed(transform(scene, mode, n))).frames))
        line('Spark', n => spark(scene, n))
        line('pruned', n => pictures(scene, packed(pruned(scene, n))).frames)
        const best = uniform.map(({ mean, worst }, i) =>
            ({ mean: Math.max(mean, adaptive[i].mean), worst: Math.max(worst, adaptive[i].worst) }))
        const ours = [['`--levels`', scene.levels], ['`--levels --refine`', refined(scene)]].map(([words, file]) =>
            [words, line(words, n => pictures(scene, file, ['--budget', n]).frames)])
        if (scene.given)
            line('`--levels --refine` without `--cameras`', n => pictures(scene, refined(scene, null), ['--budget', n]).frames)
        for (const [words, found] of ours)
            row(`${name}, ${words} above the better of splat-transform's`,
                ...found.map((f, i) => both({ mean: f.mean - best[i].mean, worst: f.worst - best[i].worst })))
    }
}

const times = (commands, more) => {
    const seconds = (words, frames) => Number(run('bash', '-c', 'TIMEFORMAT=%U; { time "$@" >/dev/null; } 2>&1', 'bash',
        fixsplat, 'bench', words, '--threads', 1, '--frames', frames))
    const rounds = Array.from({ length: ROUNDS }, () =>
        commands.map(words => 1000 * (seconds(words, 10 + more) - seconds(words, 10)) / more))
    return commands.map((_, i) => median(rounds.map(found => found[i])))
}

const less = (name, shares, more) => {
    const scene = open(name), whole = pictures(scene, scene.levels), leaves = scene.info.tree.at(-1)
    const budgets = shares.map(share => Math.round(share * scene.count))
    const found = budgets.map(n => pictures(scene, scene.levels, ['--budget', n]))
    const better = budgets.map(n => pictures(scene, refined(scene), ['--budget', n]).frames)
    const took = times(budgets.map(n => [scene.levels, scene.options, scene.timed, '--budget', n]), more)
    budgets.forEach((budget, i) => {
        const drawn = mean(found[i].stats.map(stats => stats.drawn)), bytes = drawn / 256 * leaves.bytes / leaves.nodes
        row(name, budget, `${round(100 * shares[i])} %`, Math.round(drawn), (bytes / 1e6).toFixed(2),
            both(against(whole, found[i].frames)), both(against(whole, better[i])), took[i].toFixed(2))
    })
}

const budgets = () => {
    say('PSNR compares frames with frames of all Gaussians, in dB: mean (worst) of the views. `MB` is the size of the drawn',
        'chunks, mean of the views. `ms` is the user time of a frame by one thread, on processors that had other work: the median',
        `of ${ROUNDS} rounds in turns.`)
    head('scene', 'budget', 'of all', 'drawn', 'MB', 'PSNR', 'refined', 'ms')
    for (const name of ['landscape', 'captured', 'snowmiku', 'skull', 'luma-seal', 'boatyard-tile3'].filter(isAsked))
        less(name, [1, 0.5, 0.25, 0.125, 0.0625, 0.03125], name === 'landscape' ? 20 : 50)
}

const TILE = 16

const watch = (scene, keys, films, visit) => {
    const cameras = ['--cameras', `${scenes}/${SCENES[scene.name].cameras}`, '--view', keys, '--frames', FRAMES]
    const opened = films.map(([file, ...words], i) => {
        const film = `${folder}/film-${i}.rgba`
        run(fixsplat, 'render', file, cameras, '--size', `${WIDTH}x${HEIGHT}`, words, '-o', film, '--quiet')
        const handle = openSync(film)
        rmSync(film)
        return handle
    })
    for (let number = 0; number < FRAMES; number++)
        visit(opened.map(handle => {
            const frame = Buffer.alloc(4 * WIDTH * HEIGHT)
            readSync(handle, frame)
            return frame
        }))
    opened.forEach(closeSync)
}

const change = difference => {
    const tiles = []
    let all = 0
    for (let y = 0; y < HEIGHT; y += TILE)
        for (let x = 0; x < WIDTH; x += TILE) {
            let sum = 0
            for (let v = y; v < y + TILE; v++)
                for (let i = 4 * (v * WIDTH + x), end = i + 4 * TILE; i < end; i++)
                    sum += (i & 3) === 3 ? 0 : difference(i) ** 2
            tiles.push(Math.sqrt(sum / (3 * TILE * TILE)))
            all += sum
        }
    return { rms: Math.sqrt(all / (3 * WIDTH * HEIGHT)), tiles }
}

const report = changes => {
    const tiles = changes.flatMap(found => found.tiles).sort((a, b) => a - b)
    return [Math.max(...changes.map(found => found.rms)).toFixed(2), tiles[Math.floor(0.9999 * tiles.length)].toFixed(1),
        tiles.at(-1).toFixed(1)]
}

const steps = () => {
    const scene = open('snowmiku'), quarter = ['--budget', Math.round(scene.count / 4)]
    const films = [['all', scene.levels], ['a quarter', scene.levels, ...quarter],
        ['a quarter, `--refine`', refined(scene), ...quarter]]
    say(`Steps from frame to frame, of 255: smooth ways through cameras of snowmiku in ${FRAMES} frames of`,
        `${WIDTH}x${HEIGHT}. Of all steps the largest rms of a picture, and the 99.99th percentile and the largest of the`,
        `rms of tiles of ${TILE}x${TILE}; then the same of what a step is without that of all Gaussians.`)
    head('cameras', 'drawn', 'picture', 'tiles, 99.99 %', 'tiles, most', 'without', 'tiles, 99.99 %', 'tiles, most')
    for (const keys of ['8..12', '8..9']) {
        const own = films.map(() => []), beside = films.map(() => [])
        let last
        watch(scene, keys, films.map(([, ...words]) => words), frames => {
            if (last)
                frames.forEach((now, k) => {
                    own[k].push(change(i => now[i] - last[k][i]))
                    beside[k].push(change(i => now[i] - last[k][i] - frames[0][i] + last[0][i]))
                })
            last = frames
        })
        films.forEach(([words], k) => row(keys, words, ...report(own[k]), ...(k ? report(beside[k]) : ['-', '-', '-'])))
    }
}

const [STEPS, KNOT] = [8, 100000]
// names of the emulated boards, and the instructions per second of each (docs/boards.md)
const BOARDS = [['mps2-an500', 480e6 * 1.2], ['mps3-an547', 400e6 / 1.46]]

const boards = () => {
    const source = kept('knot.ply', to => run(fixsplat, 'make-scene', 'knot', '--count', KNOT, '-o', to))
    const file = convert(source, 'knot.fxs', '--levels', '--profile', 'small'), elf = `${folder}/boards/firmware`
    const scene = { options: ['--size', '320x240', '--up', '0,-1,0', '--orbit', STEPS] }, whole = pictures(scene, file)
    run('make', '-s', `B=${folder}/boards`, 'NVCC=none', `FIRMWARE_SCENE=${file}`,
        BOARDS.map(([name]) => `${elf}/${name}.elf`))
    const turn = (name, ...words) => {
        const { stdout, stderr } = spawnSync('qemu-system-arm', ['-M', name, '-nographic', '-monitor', 'none', '-serial',
            'none', '-icount', 'shift=0', '-kernel', `${elf}/${name}.elf`, '-semihosting-config',
            ['enable=on,target=native,arg=firmware', `frames=${STEPS}`, ...words].join(',arg=')], { encoding: 'utf8' })
        return stdout + stderr
    }
    const most = (said, word) =>
        Math.max(...[...said.matchAll(new RegExp(` ${word} (\\d+)`, 'g'))].map(found => Number(found[1])))
    const rate = (said, [, second]) => second / most(said, 'ns')
    const show = budget => {
        const said = BOARDS.map(([name]) => turn(name, `budget=${budget}`))
        const least = most(turn(BOARDS[0][0], `budget=${budget}`, 'memory=0'), 'takes')
        const frames = budget < KNOT ? pictures(scene, file, ['--budget', budget]).frames : whole.frames
        const rates = said.flatMap((text, i) => [(most(text, 'ns') / 1e6).toFixed(1), rate(text, BOARDS[i]).toFixed(1)])
        row(budget, both(against(whole, frames)), ...rates, least, most(said[0], 'memory'))
    }
    say(`A knot of ${KNOT} Gaussians with levels (profile small, ${statSync(file).size} bytes, SH degree 3) makes a turn in ${STEPS} steps, at 320x240.`,
        'The columns M7 and M55 have millions of instructions of the slowest frame, and the frames a second that follow from',
        'them. PSNR in dB is against all Gaussians: mean (worst). `least` is the minimum of working memory in bytes; `memory` is',
        'the working memory of a frame if all RAM is free.')
    head('budget', 'PSNR', 'M7', 'M7 a second', 'M55', 'M55 a second', 'least', 'memory')
    let [low, high] = [1, 200]                      // limits for a bisection of the number of chunks of 256 Gaussians
    while (high - low > 1) {
        const middle = (low + high) >> 1
        if (rate(turn(BOARDS[0][0], `budget=${256 * middle}`), BOARDS[0]) >= 10) low = middle
        else high = middle
    }
    for (const budget of [KNOT, 40000, 20000, 10000, 256 * low, 2560]) show(budget)
}

const parts = { cuts, budgets, steps, boards }
if (!parts[part]) throw new Error(`no part ${part}: expected ${Object.keys(parts).join(', ')}`)
parts[part]()
