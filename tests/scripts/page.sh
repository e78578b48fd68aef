#!/bin/sh
# Tests the viewer's page in headless Chromium: pixels, controls, error messages and download sizes. PICTURES=FOLDER
# keeps pictures. FXS_PROCESSORS=all adds every captured scene.
. tests/scripts/lib/check.sh
. tests/scripts/lib/web.sh
needs page chromium -- puppeteer-core

# things: two balls of 2000 Gaussians, red and blue, on a grey floor of 3600, y down.
things() {
    awk 'function put(x, y, z, r, g, b) {
            print x, y, z, (r - 0.5) / 0.2821, (g - 0.5) / 0.2821, (b - 0.5) / 0.2821, 5, s, s, s, 1, 0, 0, 0 }
        BEGIN {
            print "ply\nformat ascii 1.0\nelement vertex 7600"
            n = split("x y z f_dc_0 f_dc_1 f_dc_2 opacity scale_0 scale_1 scale_2 rot_0 rot_1 rot_2 rot_3", name, " ")
            for (i = 1; i <= n; i++) print "property float " name[i]
            print "end_header"
            s = log(0.03)
            for (i = 0; i < 4000; i++) {
                h = 1 - (i % 2000 + 0.5) / 1000; w = sqrt(1 - h * h); a = 2.39996323 * i
                put((i < 2000 ? -1.4 : 1.4) + w * cos(a), h - 1, w * sin(a), i < 2000 ? 0.8 : 0.2, 0.2, i < 2000 ? 0.2 : 0.8)
            }
            s = log(0.06)
            for (i = 0; i < 3600; i++) put((i % 60 - 29.5) / 8, 0.05, (int(i / 60) - 29.5) / 8, 0.6, 0.6, 0.55)
        }'
}

make_scenes() {
    things >"$work/things.ply" && "$B/fixsplat" convert "$work/things.ply" "$work/things.fxs" \
        --start-view 0,-2.5,-7,0,-0.8,0 --quiet || return 1
    "$B/fixsplat" make-scene knot --count 20000 -o "$work/scene.ply" >/dev/null || return 1
    head -c 3000 "$work/scene.ply" >"$work/short.ply"
    echo 'GIF89a, and no scene' >"$work/text.ply"
    printf 'ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nend_header\n' >"$work/huge.ply"
    cat >"$work/cameras.json" <<-'END'
	[{"img_name": "front", "width": 640, "height": 360, "position": [0, 0, -9], "fx": 500, "fy": 500,
	  "rotation": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]},
	 {"img_name": "side", "width": 640, "height": 360, "position": [-9, 0, 0], "fx": 500, "fy": 500,
	  "rotation": [[0, 0, 1], [0, 1, 0], [-1, 0, 0]]}]
	END
    cat >"$work/more.json" <<-'END'
	[{"img_name": "aside", "width": 640, "height": 360, "position": [0, 0, -9], "fx": 500, "fy": 500,
	  "cx": 250, "cy": 200, "rotation": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]},
	 {"img_name": "flat", "width": 640, "height": 360, "position": [0, 0, -9], "fx": 50, "fy": 50, "orthographic": true,
	  "rotation": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}]
	END
    "$B/fixsplat" convert "$work/scene.ply" "$work/levels.fxs" --levels >/dev/null &&
        "$B/fixsplat" convert "$work/scene.ply" "$work/scene.fxs" --start-view 0,-4.2,-12.2,0,-0.2,0 >/dev/null ||
        return 1
    "$B/fixsplat" convert "$work/scene.ply" "$work/leant.fxs" --up 0.2,-0.5,0.1 --rotate 0,0,30 \
        --start-view 3,-2,-5,0,0,0,40 >/dev/null || return 1
    "$B/fixsplat" make-scene knot --count 60000 -o "$work/large.ply" >/dev/null &&
        "$B/fixsplat" convert "$work/large.ply" "$work/parts.fxs" --levels >/dev/null || return 1
    "$B/fixsplat" render "$work/scene.ply" --size 64x36 -o "$work/poster.png" >/dev/null
}

check "builds" builds
of_parts="$package/paged.js $package/store.js"      # files that the page loads with the first paged scene
of_webgpu="$package/webgpu.js $package/stages.js"
of_pages="fit.js published.js served.js list.js single.js"      # other pages
# Files that the page loads with the first annotation, track, settings file, film, sky, or text in another language.
of_tours=$(ls "$package"/viewer/*.js | grep -E '/(tour|tour_style|markers|player|settings|track)\.js')
of_hands="walk.js gamepad.js joystick.js"        # files that the page loads for walking, gamepads and touchscreens
of_tour_pages="film.js sky.js $(basename -a $of_tours) $(basename -a "$package"/viewer/language_*.js)"
of_walls=voxels.js               # file that the page loads for walking with the attribute `walls`
of_keys=keys.js                  # file that the page loads to edit a camera track
of_looks=look.js                 # file that the page loads with a settings file, a tone curve, an exposure or a vignette
of_headsets='xr.js eyes.js'      # files that the page loads with a headset
of_rooms=ar.js                   # file that the page loads for augmented reality
of_edits="edit.js editor.js"      # files that the page loads for editing by hand
of_moving=moving.js              # file that the page loads with a moving scene, beside player.js
of_sounds=sound.js               # file that the page loads with the sound of a moving scene
of_drops=drop.js                 # file that the page loads when a scene is dropped
of_errors=words.js               # file that the page loads with the first error
others=$(printf '/%s$|' $of_pages $of_tour_pages $of_keys $of_looks $of_walls $of_hands $of_headsets $of_rooms $of_drops $of_moving $of_sounds $of_edits $of_errors paged.js store.js webgpu.js \
    stages.js node.js system.js thread_node.js)
# Of this size, 1.3 KB find the package's other files, also on another server, and report missing ones. 3.4 KB end slow,
# endless or wrong downloads, keep a scene to its folder's files, and check calls.
check "size" at_most 56950 "$package"/viewer/index.html "$package"/viewer/page.css \
    $(ls "$package"/viewer/*.js "$package"/*.js | grep -Ev "${others%|}")
check "size of what scenes in parts need" at_most 8150 $of_parts
check "size of annotations, tracks and settings files" at_most 13200 $of_tours
check "size of walking, gamepads and the stick" at_most 5500 $(printf "$package/viewer/%s " $of_hands)
check "size of walls" at_most 1200 "$package/viewer/$of_walls"
check "size of a track's keys" at_most 1100 "$package/viewer/keys.js"
check "size of tone curves and vignette" at_most 1150 "$package/viewer/look.js"
check "size of moving scenes" at_most 2800 "$package/viewer/moving.js"
check "size of sound" at_most 1350 "$package/viewer/sound.js"
check "size of films" at_most 2800 "$package/viewer/film.js"
check "size of skies" at_most 2100 "$package/viewer/sky.js"
check "size of headsets" at_most 6300 $(printf "$package/viewer/%s " $of_headsets)
check "size of AR" at_most 4300 "$package/viewer/ar.js"
check "size of editing by hand" at_most 6450 "$package/editor.js" "$package/viewer/edit.js"
check "size of German" at_most 5250 "$package/viewer/language_de.js"
check "size of Chinese" at_most 5450 "$package/viewer/language_zh.js"
check "words in each language" node tests/web/language.mjs "$package/viewer"
check "size of what WebGPU needs" at_most 34000 $of_webgpu
check "makes scenes" make_scenes
if [ -d "$scenes" ]; then ln -s "$(cd "$scenes" && pwd)" "$work/real"; else skip scenes "no $scenes"; fi
asks page.mjs "${PICTURES:-$work}" "$B/fixsplat"
asks tour.mjs "${PICTURES:-$work}" "$B/fixsplat"
asks edit.mjs "${PICTURES:-$work}" "$B/fixsplat"
asks moving.mjs "${PICTURES:-$work}" "$B/fixsplat"
asks sound.mjs "${PICTURES:-$work}" "$B/fixsplat"
if [ "$FXS_PROCESSORS" = all ] && [ -d "$scenes" ]; then asks every.mjs "${PICTURES:-$work}" "$B/fixsplat"; fi
cat "$work/sizes"
finish
