// node validate_gltf.mjs NODE_MODULES FILE.glb: prints the errors that Khronos's glTF validator finds, except unknown
// extensions and attributes.
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { resolve } from 'node:path';

const [modules, file] = process.argv.slice(2);
const validator = createRequire(resolve(modules, 'x.js'))('gltf-validator');
const unknown = ['UNSUPPORTED_EXTENSION', 'MESH_PRIMITIVE_INVALID_ATTRIBUTE'];
const report = await validator.validateBytes(new Uint8Array(readFileSync(file)));
const wrong = report.issues.messages.filter((m) => !unknown.includes(m.code));
for (const m of wrong) console.log(m.code, m.pointer, m.message);
if (report.info.totalVertexCount === 0) console.log('no vertices');
process.exitCode = wrong.length || report.info.totalVertexCount === 0 ? 1 : 0;
