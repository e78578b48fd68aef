// Declares names that the TypeScript code in the documentation uses without a declaration.
declare const canvas: HTMLCanvasElement
declare const camera: import('fixsplat').Camera
declare const scene: import('fixsplat').Scene
declare module 'webgpu' {
  export function create(options: string[]): GPU
  export const globals: object
}
declare const GPUBufferUsage: Record<'COPY_DST' | 'STORAGE', number>
