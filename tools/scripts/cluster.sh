#!/bin/sh
# Fits a scene in blocks, as local or Slurm jobs: a coarse fit of the whole scene, a fit of each block that continues
# the coarse fit, and a merge. See --help.
set -u

help() {
    cat <<'END'
Usage: tools/scripts/cluster.sh PHOTOS -o OUT.fxs --blocks N [OPTION...] [-- FIT_OPTION...]

Fits a scene to photographs in N blocks: writes the jobs into a folder, runs them by GNU parallel or Slurm, waits, and
merges their results to OUT.fxs, with levels of detail. What a job writes is there whole or not at all, and what is
there is not made again: after a failure the same command makes what is missing. The file does not depend on how many
machines or processors there are.

Options:
  -o OUT.fxs          the scene
  --blocks N          blocks, 1 to 4096
  --work DIR          the folder of the jobs and their results (default: OUT.fxs.jobs); on a cluster one that all
                      machines see
  --engine NAME       parallel (default: GNU parallel on this machine) or slurm
  --jobs N            parallel: blocks at a time (default 1; each uses --threads of its own, or all processors)
  --sbatch "OPTIONS"  slurm: options of sbatch for each job, as "--cpus-per-task=16 --mem=64G"
  --coarse-steps N    steps of the coarse fit of all photographs (default 3000)
  --coarse-resolution N
                      pixels of their longer side in it, at most (default 400)
  --steps N           the last step of each block; the coarse fit's count (default 30000)
  --poll SECONDS      slurm: how often the queue is asked (default 10)
  --submit-only       slurm: do not wait; the same command without it waits, and says what is missing
  --dry-run           write the jobs, run nothing
  -h, --help          this text
  -- FIT_OPTION...    for all fits, as --sh-degree 1 --threads 16 --profile small; the coarse fit takes them too

FIXSPLAT names the command (default: fixsplat beside this script's build folder, else that of PATH).

Examples:
  $ tools/scripts/cluster.sh city -o city.fxs --blocks 16
  $ tools/scripts/cluster.sh city -o city.fxs --blocks 16 --jobs 2 --steps 10000 -- --threads 8 --resolution 1200
  $ tools/scripts/cluster.sh city -o city.fxs --blocks 64 --engine slurm --sbatch "--cpus-per-task=16 --mem=64G --time=24:00:00"
END
}

stop() {
    printf 'cluster.sh: %s\n' "$1" >&2
    exit "${2:-1}"
}

is_count() {
    case $1 in '' | *[!0-9]* | 0* | ??????????*) return 1 ;; esac
}

photos= out= blocks= work= engine=parallel jobs=1 sbatch= coarse_steps=3000 coarse_resolution=400 steps=30000 poll=10
submit_only= dry_run=
while [ $# -gt 0 ]; do
    case $1 in
        -h | --help) help; exit 0 ;;
        --submit-only) submit_only=1; shift; continue ;;
        --dry-run) dry_run=1; shift; continue ;;
        --) shift; break ;;
        -?*) [ $# -gt 1 ] || stop "$1: a value is missing" 2 ;;
        *) [ -z "$photos" ] || stop "$1: one set of photographs is taken; fit's options come behind --" 2
            photos=$1; shift; continue ;;
    esac
    case $1 in
        -o | --output) out=$2 ;;
        --blocks) blocks=$2 ;;
        --work) work=$2 ;;
        --engine) engine=$2 ;;
        --jobs) jobs=$2 ;;
        --sbatch) sbatch=$2 ;;
        --coarse-steps) coarse_steps=$2 ;;
        --coarse-resolution) coarse_resolution=$2 ;;
        --steps) steps=$2 ;;
        --poll) poll=$2 ;;
        *) stop "$1: no such option; fit's options come behind --, see --help" 2 ;;
    esac
    shift 2
done
[ -n "$photos" ] || stop "which photographs? See --help" 2
[ -e "$photos" ] || stop "$photos: no such file or folder"
case $out in *.fxs) ;; *) stop "-o '$out': expected a name ending in .fxs" 2 ;; esac
is_count "$blocks" && [ "$blocks" -le 4096 ] || stop "--blocks '$blocks': expected 1 to 4096" 2
for pair in "jobs $jobs" "coarse-steps $coarse_steps" "coarse-resolution $coarse_resolution" "steps $steps" "poll $poll"; do
    is_count "${pair#* }" || stop "--${pair%% *} '${pair#* }': expected a number from 1 on" 2
done
[ "$steps" -gt "$coarse_steps" ] || stop "--steps $steps: expected more than the coarse fit's $coarse_steps" 2
case $engine in
    parallel) needed=parallel ;;
    slurm) needed=sbatch ;;
    *) stop "--engine $engine: expected parallel or slurm" 2 ;;
esac
[ -n "$dry_run" ] || command -v $needed >/dev/null || stop "no $needed here"
if [ -z "${FIXSPLAT:-}" ]; then
    FIXSPLAT=$(dirname "$0")/../../build/fixsplat
    [ -x "$FIXSPLAT" ] || FIXSPLAT=fixsplat
fi
command -v "$FIXSPLAT" >/dev/null || stop "$FIXSPLAT: no such command; FIXSPLAT names it"
case $out in -*) out=./$out ;; esac
work=${work:-$out.jobs}
mkdir -p -- "$work" || exit 1

whole() {
    folder=$(cd -- "$(dirname -- "$1")" && pwd) || exit 1
    printf '%s\n' "$folder/$(basename -- "$1")"
}
# words WORD...: quotes words for a shell.
words() {
    for word; do
        printf " '%s'" "$(printf %s "$word" | sed "s/'/'\\\\''/g")"
    done
}
case $FIXSPLAT in */*) FIXSPLAT=$(whole "$FIXSPLAT") ;; esac
work=$(cd -- "$work" && pwd) || exit 1
# A resumed fit needs a recipe (set of fit settings) that does not adapt to the number of steps.
case " $* " in
    *" --recipe"* | *" --quality"*) ;;
    *) set -- --recipe reference "$@" ;;
esac
fit=$(words "$FIXSPLAT" fit "$(whole "$photos")" "$@")
parts=$(seq 0 "$blocks" | sed "s/.*/part-&.ply/" | tr '\n' ' ')

# Refuses a work folder with results of jobs that had other options.
settings="blocks $blocks, coarse fit $coarse_steps steps at $coarse_resolution, $steps steps,$fit"
if [ -e "$work/settings" ] && [ "$(cat "$work/settings")" != "$settings" ]; then
    stop "$work: the jobs there are of other options: $(cat "$work/settings"); remove it, or choose another --work"
fi
printf '%s\n' "$settings" >"$work/settings.new" && mv "$work/settings.new" "$work/settings" || exit 1

# If the command line has --resolution twice, the last one takes effect.
cat >"$work/coarse.sh" <<END
#!/bin/sh
cd $(words "$work") || exit 1
[ -e coarse.fit ] || exec $fit -o coarse.fit --steps $coarse_steps --resolution $coarse_resolution
END
cat >"$work/block.sh" <<END
#!/bin/sh
# Fits the block of a given number. Block 0 is what lies outside of all other blocks.
cd $(words "$work") || exit 1
part=part-\${1:-\$SLURM_ARRAY_TASK_ID}
[ -e \$part.ply ] || exec $fit -o \$part.ply --coarse coarse.fit --block \${part#part-}/$blocks --steps $steps
END
cat >"$work/merge.sh" <<END
#!/bin/sh
cd $(words "$work") || exit 1
for part in $parts; do
    [ -e \$part ] || { printf '%s is missing: its job failed, see its log in %s\n' \$part$(words "$work") >&2; exit 1; }
done
[ -e all.fxs ] || exec $(words "$FIXSPLAT") convert $parts all.fxs --levels
END
chmod +x "$work/coarse.sh" "$work/block.sh" "$work/merge.sh" || exit 1
[ -z "$dry_run" ] || { printf '%s: coarse.sh, block.sh and merge.sh are written\n' "$work"; exit 0; }

# missing: prints the numbers of blocks without a result, separated by commas.
missing() {
    for block in $(seq 0 "$blocks"); do
        [ -e "$work/part-$block.ply" ] || printf '%s,' "$block"
    done | sed 's/,$//'
}
say_failed() {
    for log in coarse $(seq 0 "$blocks") merge; do
        [ ! -s "$work/$log.log" ] || grep -h '^fixsplat: ' "$work/$log.log" | tail -n 1 | sed "s/^/$log.log: /"
    done >&2
}

by_parallel() {
    (FIXSPLAT_QUIET=1 "$work/coarse.sh" >"$work/coarse.log" 2>&1) || return 1
    (cd "$work" && FIXSPLAT_QUIET=1 parallel -j "$jobs" "./block.sh {} >{}.log 2>&1" ::: $(missing | tr ',' ' ')) ||
        return 1
    (FIXSPLAT_QUIET=1 "$work/merge.sh" >"$work/merge.log" 2>&1)
}

# submit NAME OPTION... SCRIPT: submits a Slurm job and prints its number. Slurm expands % and \ in the name of an
# output file, but not in its folder's name.
submit() {
    name=$1
    shift
    sbatch --parsable --chdir="$work" --export=ALL,FIXSPLAT_QUIET=1 --job-name="fixsplat-$name" $sbatch "$@" | sed 's/;.*//'
}

submit_all() {
    coarse=$(submit coarse --output=coarse.log "$work/coarse.sh") && [ -n "$coarse" ] || return 1
    after=$coarse
    left=$(missing)
    if [ -n "$left" ]; then
        after=$(submit blocks --array="$left" --dependency="afterok:$coarse" --kill-on-invalid-dep=yes \
            --output=%a.log "$work/block.sh") && [ -n "$after" ] || return 1
    fi
    merge=$(submit merge --dependency="afterok:$after" --kill-on-invalid-dep=yes --output=merge.log \
        "$work/merge.sh") && [ -n "$merge" ] || return 1
    echo "$coarse,$after,$merge" >"$work/submitted"
}

is_queued() { [ -e "$work/submitted" ] && squeue -h -j "$(cat "$work/submitted")" -o %i 2>/dev/null | grep -q .; }

by_slurm() {
    is_queued || submit_all || return 1
    [ -z "$submit_only" ] || { echo "jobs $(cat "$work/submitted")"; exit 0; }
    while is_queued; do
        sleep "$poll"
    done
    [ -e "$work/all.fxs" ]
}

if [ ! -e "$work/all.fxs" ]; then
    by_$engine || {
        say_failed
        left=$(missing)
        stop "not done${left:+, blocks without a result: $left}; the logs are in $work, and the same command goes on"
    }
fi
cp "$work/all.fxs" "$out.new" && mv "$out.new" "$out" || exit 1
printf '%s: of %s blocks, in %s\n' "$out" "$blocks" "$work"
