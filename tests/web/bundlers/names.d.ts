// Declares names that the code in the documentation assumes.
declare const canvas: HTMLCanvasElement
declare const camera: import('fixsplat').Camera
declare const scene: import('fixsplat').Scene
declare module 'webgpu' {
  export function create(options: string[]): GPU
  export const globals: object
}
declare const GPUBufferUsage: Record<'COPY_DST' | 'STORAGE', number>
