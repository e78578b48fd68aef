// What lines of the documentation take as given.
declare const canvas: HTMLCanvasElement
declare const camera: import('fixsplat').Camera
declare const scene: import('fixsplat').Scene
declare module 'webgpu' {
  export function create(options: string[]): GPU
  export const globals: object
}
/** Which TypeScript has not, but npm's @webgpu/types. */
declare const GPUBufferUsage: Record<'COPY_DST' | 'STORAGE', number>
