#!/usr/bin/env bash
# A Slurm cluster on this machine, for tests: controller and two compute nodes
# under a folder of their own, with Debian's slurm-wlm and munge.
#   slurm-here.sh start DIR   writes DIR/env, to be sourced for sbatch and squeue
#   slurm-here.sh kill DIR N  kills node N (0 or 1) with all its jobs
#   slurm-here.sh node DIR N  starts it again
#   slurm-here.sh stop DIR
set -euo pipefail

action=${1:?start, kill, node or stop}
folder=$(realpath -m "${2:?a folder}")
host=$(hostname -s)

fail() {
    printf 'error: %s\n' "$1" >&2
    exit 1
}

start_node() {
    slurmd -N "node$1" -f "$folder/slurm.conf" -L "$folder/node$1.log"
}

case $action in
start)
    for tool in munged slurmctld slurmd sbatch; do
        command -v "$tool" >/dev/null ||
            fail "$tool is missing. Try: apt-get install slurm-wlm munge"
    done
    mkdir -p "$folder/state" "$folder/spool-node0" "$folder/spool-node1" "$folder/munge"
    chmod 755 "$folder" "$folder/munge"
    [ -f "$folder/munge/key" ] || head -c 128 /dev/urandom >"$folder/munge/key"
    chmod 600 "$folder/munge/key"
    munged --force --key-file="$folder/munge/key" --socket="$folder/munge/socket" \
        --pid-file="$folder/munge/pid" --seed-file="$folder/munge/seed" \
        --log-file="$folder/munge/log"
    cat >"$folder/slurm.conf" <<EOF
ClusterName=here
SlurmctldHost=$host(localhost)
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
AuthType=auth/munge
AuthInfo="socket=$folder/munge/socket"
SlurmctldPort=16817
StateSaveLocation="$folder/state"
SlurmdSpoolDir="$folder/spool-%n"
SlurmctldPidFile="$folder/slurmctld.pid"
SlurmdPidFile="$folder/%n.pid"
SlurmctldLogFile="$folder/slurmctld.log"
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=sched_interval=2,bf_interval=2
ReturnToService=2
SlurmdTimeout=15
MinJobAge=3600
JobRequeue=1
NodeName=node0 NodeHostname=$host NodeAddr=127.0.0.1 Port=16818 CPUs=1 RealMemory=500
NodeName=node1 NodeHostname=$host NodeAddr=127.0.0.1 Port=16819 CPUs=1 RealMemory=500
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
EOF
    slurmctld -f "$folder/slurm.conf" -L "$folder/slurmctld.log"
    start_node 0
    start_node 1
    printf 'export SLURM_CONF=%q\n' "$folder/slurm.conf" >"$folder/env"
    export SLURM_CONF=$folder/slurm.conf
    for _ in $(seq 60); do
        [ "$(sinfo -h -o '%t' 2>/dev/null | sort -u)" = idle ] && exit 0
        sleep 1
    done
    sinfo >&2 || true
    fail "the nodes did not come up; see $folder/*.log"
    ;;
kill)
    node=node${3:?0 or 1}
    kill -9 "$(cat "$folder/$node.pid")" 2>/dev/null || true
    # Its jobs carry its name; processes may end while they are looked at.
    for pid in $(pgrep -f .); do
        if grep -qsz "^SLURMD_NODENAME=$node\$" "/proc/$pid/environ"; then
            kill -9 "$pid" 2>/dev/null || true
        fi
    done
    ;;
node)
    start_node "${3:?0 or 1}"
    ;;
stop)
    for pid in "$folder"/node?.pid "$folder/slurmctld.pid" "$folder/munge/pid"; do
        [ -f "$pid" ] && kill "$(cat "$pid")" 2>/dev/null || true
    done
    ;;
*)
    fail "$action is none of start, kill, node, stop"
    ;;
esac
