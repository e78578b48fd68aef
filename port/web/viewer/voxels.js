// Solid voxels of a scene, as `fixsplat collide` and splat-transform write them: X.voxel.json and X.voxel.bin.
// src/surface/voxels_write.c describes the octree. Its axes are (-x, -y, z) of the scene's.
import { download } from 'fixsplat/read.js'
import { add, cross, dot, unit } from './motion.js'
import { addressOf, textAt } from './views.js'

const MOST = 1 << 28
const SOLID = 0xff000000

const ones = (x) => (x ? (x & 1) + ones(x >>> 1) : 0)

export class Voxels {
  /** `facts` is the content of the .voxel.json, `words` that of the .voxel.bin. */
  constructor(facts, words) {
    const { gridBounds, voxelResolution, treeDepth, nodeCount } = facts
    Object.assign(this, { low: gridBounds.min, size: voxelResolution, depth: treeDepth, nodeCount, words })
    this.count = gridBounds.max.map((high, i) => Math.round((high - this.low[i]) / this.size))
  }

  /** Returns true at solid places, and outside of the box. */
  isSolid([x, y, z]) {
    const at = [-x, -y, z].map((a, i) => Math.floor((a - this.low[i]) / this.size))
    if (at.some((a, i) => !(a >= 0 && a < this.count[i]))) return true
    let node = 0
    for (let level = this.depth; ; level--) {
      const word = this.words[node]
      const mask = word >>> 24
      if (word === SOLID) return true
      if (!mask || level <= 0) return !mask && this.#bit(word, at)
      const child = at.reduce((sum, a, i) => sum + (((a >> (level + 1)) & 1) << i), 0)
      if (!((mask >> child) & 1)) return false
      node = (word & 0xffffff) + ones(mask & ((1 << child) - 1))
    }
  }

  #bit(leaf, [x, y, z]) {
    const bit = 16 * (z & 3) + 4 * (y & 3) + (x & 3)
    return !!((this.words[this.nodeCount + 2 * leaf + (bit >> 5)] >>> (bit & 31)) & 1)
  }

  /** Counts the solid places of a column around a point, a voxel apart, at heights from `low` to `high`. */
  stops(point, up, radius, low, high) {
    const right = unit(cross(up, Math.abs(up[0]) < 0.9 ? [1, 0, 0] : [0, 0, 1]))
    const ahead = cross(up, right)
    const far = Math.floor(radius / this.size)
    const level = dot(point, up)
    let found = 0
    for (let i = -far; i <= far; i++)
      for (let j = -far; j <= far; j++) {
        if (i * i + j * j > far * far) continue
        const foot = add(add(point, right, i * this.size), ahead, j * this.size)
        for (let y = low; y <= high; y += this.size) found += this.isSolid(add(foot, up, y - level))
      }
    return found
  }
}

export async function readVoxels(address) {
  const facts = JSON.parse(await textAt(address, 'there are no walls at this address'))
  const file = await download(new URL(addressOf(address.replace(/\.json$/, '.bin'))), { most: MOST })
  const bytes = file.first(file.there)
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength)
  const words = Uint32Array.from({ length: bytes.byteLength >> 2 }, (_, i) => view.getUint32(4 * i, true))
  if (!(facts.nodeCount > 0) || words.length !== facts.nodeCount + facts.leafDataCount)
    throw new Error(`${address}: these are no walls`)
  return new Voxels(facts, words)
}
