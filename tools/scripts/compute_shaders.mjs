// node tools/scripts/compute_shaders.mjs MODULES FOLDER: makes the compute shaders from kernels/compute/*.wgsl and
// src/include/fixsplat/internal/pixel.h, with naga-wasm (npm) in MODULES/node_modules. Writes FOLDER/ENTRY.comp, each
// entry point in GLSL ES 3.10 without unneeded white space. The repository stores these files in
// kernels/compute/generated. In another FOLDER, also writes STAGE.wgsl, which is complete for WebGPU.
import { writeFileSync } from "node:fs";
import { pathToFileURL } from "node:url";
import { resolve } from "node:path";
import { room, stages, stageText } from "./stages.mjs";

const [modules, folder] = process.argv.slice(2);
const { parseWgsl, validate, writeGlsl } =
    await import(pathToFileURL(resolve(modules, "node_modules/naga-wasm/dist/node.js")));

// Removes functions, constants and structs that are used nowhere, and then those that only these used.
function reachable(text)
{
    const parts = /^(?:const \w+ (\w+) = .*|struct (\w+) \{\n[^]*?^\};|(?!layout)\w+ (\w+)\(.*\) \{\n[^]*?^\})\n/gm;
    const isUsed = (name) => name === "main" || text.match(RegExp(`\\b${name}\\b`, "g")).length > 1;
    const less = text.replace(parts, (part, ...names) => isUsed(names.find(Boolean)) ? part : "");
    return less === text ? text : reachable(less);
}

// Joins a block of lines from naga (the shader translator) to one expression. A variable of a line `type name = value;`
// is replaced by its value. Assignments are joined by commas.
function oneLine(lines, last = "")
{
    const values = new Map(), done = [];
    const whole = (text) => text.replace(/_e\d+/g, (name) => values.get(name) ?? name);
    for (const [, type, name, value] of lines.matchAll(/^ *(?:(\w+) )?(\w+) = (.*);$/gm)) {
        if (type)
            values.set(name, whole(value));
        else
            done.push(`${name} = ${whole(value)}`);
    }
    return last ? whole(last) : done.join(", ");
}

// Rewrites endless loops from naga (the shader translator) as for loops, which drivers can unroll.
function loops(glsl)
{
    return glsl
        .replace(/^( *)bool (loop_init\w*) = true;\n *while\(true\) \{\n *if \(!\2\) \{\n((?:.*;\n)+) *\}\n *\2 = false;\n/gm,
                 (_, space, name, step) => `${space}for (; ; ${oneLine(step)}) {\n`)
        .replace(/^( *for \(; ); (.*\) \{\n)((?: *\w+ _e\d+ = .*;\n)*) *if \((.*)\) \{\n *\} else \{\n *break;\n *\}\n/gm,
                 (_, start, rest, before, test) => `${start}${oneLine(before, test)}; ${rest}`);
}

// Adapts GLSL code from naga (the shader translator). Adds the bindings that GLSL ES requires. Removes the zeroing of
// workgroup memory. Replaces read-modify-write atomics by plain loads and stores, which threads need not wait for.
function glslText(wgsl, entry)
{
    const module = parseWgsl(wgsl), info = validate(module);
    return loops(reachable(writeGlsl(module, info, { version: "310 es", stage: "compute", entryPoint: entry })))
        .replace(/layout\((std\d+)\)([^{]*\{[^}]*_group_\d_binding_(\d)_cs)/g, "layout($1, binding = $3)$2")
        .replace(/    if \(gl_LocalInvocationID == uvec3\(0u\)\) \{[^}]*\}\n    memoryBarrierShared\(\);\n    barrier\(\);\n/,
                 "")
        .replace(/ = atomicOr\((.*), 0u\);/g, " = $1;")
        .replace(/^( *)atomicExchange\((.*), (.*)\);/gm, "$1$2 = $3;")
        .replace(/(uvec2 mul_wide\(uint (\w+), uint (\w+)\) )\{[^}]*\}/,
                 "$1{\n    uint high;\n    uint low;\n    umulExtended($2, $3, high, low);\n" +
                 "    return uvec2(low, high);\n}");
}

// Removes white space that GLSL does not need, and breaks lines at 120 columns.
function minified(glsl)
{
    const short = (part) => part.trim().replace(/\s+/g, " ").replace(/ ?([{}()[\],;=*/<>!&|?:^%]) ?/g, "$1")
                                .replace(/(.{1,119}[;{}, ])/g, "$1\n").replace(/ \n/g, "\n").trim();
    return glsl.split(/^(#.*)\n/m).map((part) => part.startsWith("#") ? part : short(part))
               .filter((part) => part).join("\n") + "\n";
}

for (const stage of stages) {
    const wgsl = stageText(stage);
    if (resolve(folder) !== resolve(`${room}/generated`))
        writeFileSync(`${folder}/${stage}.wgsl`, wgsl);
    for (const [, entry] of wgsl.matchAll(/@compute[^]*?fn (\w+)\(/g))
        writeFileSync(`${folder}/${entry}.comp`, minified(glslText(wgsl, entry)));
}
