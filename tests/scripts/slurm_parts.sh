#!/bin/sh
# Runs `fixsplat convert --block` as a Slurm array job, with one task killed and requeued. Only with FXS_PROCESSORS=all.
. tests/scripts/lib/check.sh
. tests/scripts/lib/slurm.sh
[ "$FXS_PROCESSORS" = all ] || { skip slurm_parts "only in make test-all"; finish; exit; }
lacks=$(slurm_lacks)
[ -z "$lacks" ] || { skip slurm_parts "$lacks"; finish; exit; }
. tests/scripts/lib/command.sh
trap 'slurm_stop; rm -rf "$work"' EXIT

succeeds "scene" make-scene landscape --count 20000 -o scene.ply
succeeds "one run" convert scene.ply one.fxs --levels
cat >job.sh <<JOB
#!/bin/sh
[ "\$SLURM_ARRAY_TASK_ID" != 2 ] || [ -n "\$SLURM_RESTART_COUNT" ] || sleep 600
exec $fixsplat convert scene.ply part-\$SLURM_ARRAY_TASK_ID.fxs --quiet --levels --block \$SLURM_ARRAY_TASK_ID/4
JOB
# Slurm starts in the main shell, because its daemons must be children of this shell.
if slurm_start "$work/slurm" >logs/slurm; then ok "Slurm starts"; else fail "Slurm starts" "$(cat logs/slurm)"; finish; exit; fi
job=$(sbatch --parsable --requeue --array=1-4 --output=logs/task-%a job.sh)
check "task 2 runs" slurm_running "${job}_2"
check "task 2 is killed and queued again" scontrol requeue "${job}_2"
check "the array ends" slurm_wait "$job"
check "all tasks are done" equal "$(slurm_states "$job" | tr '\n' ' ')" "1 COMPLETED 2 COMPLETED 3 COMPLETED 4 COMPLETED "
succeeds "merged" convert part-1.fxs part-2.fxs part-3.fxs part-4.fxs all.fxs
check "the bytes of one run" cmp all.fxs one.fxs
finish
