#!/bin/sh
# peers.sh [ROUNDS [SCENE...]]: the page beside @playcanvas/supersplat-viewer and @sparkjsdev/spark, the newest of npm, in
# headless Chromium without a GPU, 1280x720: download, first complete picture, time of a frame in motion. Prints a table;
# pictures lie in B/peers/pictures. VIEWERS="fixsplat Spark" for some; docs/measured.md says how it is measured.
# B: build folder, with `make all web`; SCENES: folder of real scenes.
set -eu
B=${B:-build} SCENES=${SCENES:-../shared/scenes}
cores=
command -v taskset >/dev/null && cores='taskset -c 0,1'
mkdir -p "$B/peers/pictures"
[ -f "$B/peers/landscape.ply" ] || "$B/fixsplat" make-scene landscape --count 1000000 -o "$B/peers/landscape.ply"
npm install --silent --prefix "$B/peers" @playcanvas/supersplat-viewer@latest @sparkjsdev/spark@latest three@latest puppeteer-core
exec $cores node tests/web/peers.mjs "$B/web/package" "$SCENES" "$B/peers" "$B/peers/node_modules" "$B/peers/pictures" "$@"
