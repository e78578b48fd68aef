#!/bin/sh
# cutoffs.sh SCENE[@PHOTOS]...: prints a Markdown table that compares two cut-off radii (where Gaussians end) for each
# scene. Every eighth photograph in PHOTOS/images is compared with the rendered scene. B: build folder. VIEWS: views per
# scene (default 8). SIZE: picture size of timed frames.
set -eu
fixsplat=${B:-build}/fixsplat
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT TERM

field() { sed -n "s/.*[{ ]\"$1\": \([0-9.a-z]*\).*/\1/p"; }

photographs() {
    ls "$1/images" | awk 'NR % 8 == 1' | while read -r name; do
        "$fixsplat" render "$work/scene.fxs" --cameras "$1" --view "$name" --cutoff "$2" -o "$work/view.png" >&2
        "$fixsplat" compare "$work/view.png" "$1/images/$name" --json
    done >"$work/photographs"
    field psnr <"$work/photographs" >"$work/psnr"
    field ssim <"$work/photographs" | paste "$work/psnr" - |
        awk '{ psnr += $1; ssim += $2 } END { printf "%.2f | %.4f", psnr / NR, ssim / NR }'
}

row() {
    "$fixsplat" bench "$work/scene.fxs" --cutoff "$3" --size "${SIZE:-1280x720}" --json ${2:+--cameras "$2"} >"$work/times"
    "$fixsplat" info "$4" --compare "$4" --cutoff "$3" --compare-cutoff square \
        --views "${VIEWS:-8}" --json ${2:+--cameras "$2"} | sed 's/.*"compare": {"views": [^]]*\], /{ /' >"$work/beside"
    photographs='- | -'
    [ -z "$2" ] || photographs=$(photographs "$2" "$3")
    echo "| $1, $3 | $photographs | $(field psnr <"$work/beside" | sed s/null/equal/) | $(field ssim <"$work/beside") |" \
        "$(field blend <"$work/times") | $(field frame_ms <"$work/times") |"
}

[ $# -gt 0 ] || { echo 'usage: sh tools/scripts/cutoffs.sh SCENE[@PHOTOS]...' >&2; exit 2; }
echo '| scene, cut-off | PSNR to photographs, dB | SSIM | PSNR to the square, dB | SSIM | blend, ms | frame, ms |'
echo '|---|---|---|---|---|---|---|'
for scene; do
    case $scene in *@*) photos=${scene##*@} ;; *) photos= ;; esac
    name=${scene%@*}
    "$fixsplat" convert "$name" "$work/scene.fxs"
    for cutoff in square mahalanobis; do
        row "$(basename "$name")" "$photos" $cutoff "$name"
    done
done
