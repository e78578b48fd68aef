# Runs a private Slurm cluster on the local machine, for tests started by root.
#
#     slurm_lacks             prints why Slurm cannot run; prints nothing if it can
#     slurm_start FOLDER      starts Slurm's daemons, exports SLURM_CONF, and waits until jobs can run
#     slurm_running TASK      waits until a task (JOB_INDEX, or JOB) runs
#     slurm_wait JOB          waits up to $slurm_limit seconds (300) for the end of a job
#     slurm_states JOB        prints the states of the job's tasks, such as "0 COMPLETED"
#     slurm_stop              ends all jobs and the daemons

slurm_pids= slurm_folder=

slurm_lacks() {
    for program in munged slurmctld slurmd sbatch; do
        have $program || { echo "no $program here (Debian: slurm-wlm)"; return; }
    done
    [ "$(id -u)" = 0 ] || echo "Slurm's daemons are started by root"
}

# Slurm's credentials expire early here, because a task that is queued again waits until they have expired.
slurm_write() {
    node=$(hostname -s)
    cat >"$slurm_folder/slurm.conf" <<END
ClusterName=tests
SlurmctldHost=$node(127.0.0.1)
SlurmctldPort=$1
SlurmdPort=$(($1 + 1))
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$slurm_folder/munge.socket,cred_expire=10
CredType=cred/munge
StateSaveLocation=$slurm_folder/state
SlurmdSpoolDir=$slurm_folder/spool
SlurmctldPidFile=$slurm_folder/slurmctld.pid
SlurmdPidFile=$slurm_folder/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=batch_sched_delay=1,sched_interval=2
MpiDefault=none
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
KillWait=2
ReturnToService=2
NodeName=$node NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=$node Default=YES MaxTime=INFINITE State=UP
END
}

slurm_daemon() {
    "$@" >>"$slurm_folder/$1.log" 2>&1 </dev/null &
    slurm_pids="$! $slurm_pids"
}

slurm_until() {
    tries=$(($1 * 5))
    shift
    until "$@" >/dev/null 2>&1; do
        [ $((tries -= 1)) -gt 0 ] || return 1
        sleep 0.2
    done
}

slurm_is_up() { sinfo -h -o %t | grep -qx idle; }
slurm_is_over() { ! squeue -h ${1:+-j "$1"} -o %i | grep -q .; }
slurm_is_running() { squeue -h -t RUNNING -j "$1" -o %i | grep -q .; }
slurm_is_dead() { ! kill -0 "$1"; }

slurm_start() {
    slurm_folder=$1
    mkdir -p "$slurm_folder/state" "$slurm_folder/spool" && chmod 755 "$slurm_folder" || return 1
    export SLURM_CONF="$slurm_folder/slurm.conf"
    (umask 077 && head -c 128 /dev/urandom >"$slurm_folder/munge.key")
    slurm_daemon munged -F --force --key-file="$slurm_folder/munge.key" --socket="$slurm_folder/munge.socket" \
        --pid-file="$slurm_folder/munge.pid" --seed-file="$slurm_folder/munge.seed"
    munged=$!
    for port in $((20000 + $$ % 5000 * 2)) $((40000 + $$ % 5000 * 2)); do
        slurm_write $port
        slurm_until 20 test -S "$slurm_folder/munge.socket" || break
        slurm_daemon slurmctld -D -i
        slurm_daemon slurmd -D
        slurm_until 20 slurm_is_up && return
        slurm_end ${slurm_pids%"$munged "}
        slurm_pids="$munged "
    done
    tail -n 3 "$slurm_folder"/*.log
    slurm_stop
    return 1
}

slurm_running() { slurm_until 60 slurm_is_running "$1"; }
slurm_wait() { slurm_until "${slurm_limit:-300}" slurm_is_over "$1"; }

slurm_states() {
    scontrol -o show job "$1" | awk '{
        task = 0
        for (i = 1; i <= NF; i++) {
            if ($i ~ /^ArrayTaskId=/) task = substr($i, 13)
            if ($i ~ /^JobState=/) state = substr($i, 10)
        }
        print task, state
    }' | sort -n
}

slurm_end() {
    kill "$@"
    for pid; do
        slurm_until 10 slurm_is_dead "$pid" || kill -s KILL "$pid"
        wait "$pid"
    done
} 2>/dev/null

slurm_stop() {
    [ -n "$slurm_pids" ] || return 0
    if slurm_is_up || sinfo -h >/dev/null; then
        scancel --user="$(id -un)"
        slurm_until 20 slurm_is_over
    fi
    slurm_end $slurm_pids
    slurm_pids=
} 2>/dev/null
