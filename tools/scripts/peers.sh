#!/bin/sh
# peers.sh [ROUNDS [SCENE...]]: compares fixsplat's page with the newest PlayCanvas and Spark viewers of npm, in
# headless Chromium without a GPU. Prints a table; pictures go to B/peers/pictures. VIEWERS="fixsplat Spark" selects
# viewers. B: build folder; SCENES: folder of scenes.
set -eu
B=${B:-build} SCENES=${SCENES:-../shared/scenes}
cores=
command -v taskset >/dev/null && cores='taskset -c 0,1'
mkdir -p "$B/peers/pictures"
[ -f "$B/peers/landscape.ply" ] || "$B/fixsplat" make-scene landscape --count 1000000 -o "$B/peers/landscape.ply"
npm install --silent --prefix "$B/peers" @playcanvas/supersplat-viewer@latest @sparkjsdev/spark@latest three@latest puppeteer-core
exec $cores node tests/web/peers.mjs "$B/web/package" "$SCENES" "$B/peers" "$B/peers/node_modules" "$B/peers/pictures" "$@"
