// node tools/compute_shaders.mjs MODULES FOLDER: writes the compute shaders to FOLDER: ENTRY.comp, each entry point in GLSL
// ES 3.10 (kernels/compute has these), and STAGE.wgsl, whole as WebGPU takes them, if FOLDER is another one. They are
// made of kernels/compute/*.wgsl and src/include/fixsplat/pixel.h; naga-wasm (npm) is in MODULES/node_modules.
import { writeFileSync } from "node:fs";
import { pathToFileURL } from "node:url";
import { resolve } from "node:path";
import { room, stages, stageText } from "./stages.mjs";

const [modules, folder] = process.argv.slice(2);
const { parseWgsl, validate, writeGlsl } =
    await import(pathToFileURL(resolve(modules, "node_modules/naga-wasm/dist/node.js")));

// The functions that main needs, in their order.
function reachable(text)
{
    const functions = [...text.matchAll(/^(?!const|struct|layout)\w+ (\w+)\([^\n]*\) \{\n[^]*?^\}\n/gm)];
    const needed = new Set(), look = ["main"];
    while (look.length) {
        const name = look.pop();
        if (needed.has(name))
            continue;
        needed.add(name);
        const body = functions.find((one) => one[1] === name)[0];
        look.push(...functions.map((one) => one[1]).filter((other) => body.includes(`${other}(`)));
    }
    return functions.reduce((rest, one) => needed.has(one[1]) ? rest : rest.replace(one[0], ""), text);
}

// What naga leaves out: the bindings, which a buffer of GLSL ES names in its text. And what it puts in: workgroup memory
// is set to 0 by one thread alone, which no stage relies on, and an atomic is read and written by atomics that change it,
// which threads wait for; it can be read and written as it is.
function glslText(wgsl, entry)
{
    const module = parseWgsl(wgsl), info = validate(module);
    return reachable(writeGlsl(module, info, { version: "310 es", stage: "compute", entryPoint: entry }))
        .replace(/layout\((std\d+)\)([^{]*\{[^}]*_group_\d_binding_(\d)_cs)/g, "layout($1, binding = $3)$2")
        .replace(/    if \(gl_LocalInvocationID == uvec3\(0u\)\) \{[^}]*\}\n    memoryBarrierShared\(\);\n    barrier\(\);\n/,
                 "")
        .replace(/ = atomicOr\((.*), 0u\);/g, " = $1;")
        .replace(/^( *)atomicExchange\((.*), (.*)\);/gm, "$1$2 = $3;")
        .replace(/(uvec2 mul_wide\(uint (\w+), uint (\w+)\) )\{[^}]*\}/,
                 "$1{\n    uint high;\n    uint low;\n    umulExtended($2, $3, high, low);\n" +
                 "    return uvec2(low, high);\n}");
}

for (const stage of stages) {
    const wgsl = stageText(stage);
    if (resolve(folder) !== resolve(room))
        writeFileSync(`${folder}/${stage}.wgsl`, wgsl);
    for (const [, entry] of wgsl.matchAll(/@compute[^]*?fn (\w+)\(/g))
        writeFileSync(`${folder}/${entry}.comp`, glslText(wgsl, entry).replace(/^ *\n/gm, ""));
}
