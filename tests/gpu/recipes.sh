#!/bin/sh
# Prints quality and time of fits, a line a fit: seconds, PSNR and SSIM of the held-out photographs, PSNR and name of the
# worst of them, and milliseconds of the stages of a step (project, bin, blend, loss, back, update).
#   sh tests/gpu/recipes.sh PHOTOS...
# B: build folder. RECIPES (default: fast mcmc reference), SEEDS (default: 0 1 2), BACKENDS (default: cuda), and OPTIONS
# of fixsplat fit choose the fits.
B=${B:-build}
failed=

field() { sed -n "s/.*\"$1\": \"*\([^\",}]*\).*/\1/p" "$work"; }

row() {
    worst=$(field worst_view)
    name=$(grep -o "{\"view\": $worst, [^}]*" "$work" | sed 's/.*"name": "\([^"]*\)".*/\1/')
    stages=$(grep -o '"stages_ms": {[^}]*' "$work" | tr -dc '0-9. ' | tr -s ' ')
    printf '%s\t' "$(basename "$1")" "$2" "$3" "$4" "$(field gaussians)" "$(field seconds)" "$(field psnr)" \
        "$(field ssim)" "$(field worst_psnr)" "$name"
    echo "$stages"
}

work=$(mktemp) || exit 1
trap 'rm -f "$work" "$work.fxs"' EXIT
printf 'set\trecipe\tbackend\tseed\tGaussians\tseconds\tPSNR\tSSIM\tworst\tview\tstages\n'
for photos in "$@"; do
    case $photos in *lego*) background="--background ffffff" ;; *) background= ;; esac
    for recipe in ${RECIPES:-fast mcmc reference}; do
        for backend in ${BACKENDS:-cuda}; do
            for seed in ${SEEDS:-0 1 2}; do
                if "$B/fixsplat" fit "$photos" -o "$work.fxs" --recipe $recipe --seed $seed --backend $backend \
                    --quiet --json $background $OPTIONS >"$work"; then
                    row "$photos" $recipe $backend $seed
                else
                    failed="$failed $photos-$recipe-$backend-$seed"
                fi
            done
        done
    done
done
[ -z "$failed" ] || { echo "failed:$failed"; exit 1; }
