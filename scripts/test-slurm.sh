#!/usr/bin/env bash
# A sweep of 24 runs through a Slurm cluster on this machine, with a node killed
# in mid-run and a task over its time limit: complete in the end, and the same
# as without Slurm.
set -euo pipefail
cd "$(dirname "$0")/.."

program=${PLUVIA:-target/debug/pluvia}
folder=$PWD/target/slurm
scenario=$PWD/scripts/tiny.json

fail() {
    printf 'error: %s\n' "$1" >&2
    exit 1
}

scripts/slurm-here.sh stop "$folder/cluster" 2>/dev/null || true
rm -rf "$folder"
mkdir -p "$folder"
sweep=("$scenario" --over contact.grain_grain_friction=0.3,0.5,0.7
    --over stages.1.falling_height_mm=0,20,40,60 --configurations 2)

"$program" sweep "${sweep[@]}" --quiet --out "$folder/local" >/dev/null
scripts/slurm-here.sh start "$folder/cluster"
trap 'scripts/slurm-here.sh stop "$folder/cluster"' EXIT
. "$folder/cluster/env"

# Waits until no job is left, at most $1 seconds.
drained() {
    for _ in $(seq "$1"); do
        [ -z "$(squeue -h)" ] && return
        sleep 1
    done
    squeue >&2
    fail "jobs are left after $1 s"
}

# A name that shells and sbatch could stumble over.
sent="$folder/it's a \"sweep\" of 100 %"
"$program" sweep "${sweep[@]}" --slurm --time 00:10:00 --out "$sent"
for _ in $(seq 60); do
    squeue -h -t running -w node0 -o %i | grep -q . && break
    sleep 0.2
done
lost=$(squeue -h -t running -w node0 -o %i)
[ -n "$lost" ] || fail "nothing runs on node 0, so that nothing can be killed"
scripts/slurm-here.sh kill "$folder/cluster" 0
printf 'killed node 0 in the middle of %s\n' "$lost"
sleep 20
scripts/slurm-here.sh node "$folder/cluster" 0
drained 300
"$program" sweep --status --out "$sent"
# What was lost with the node, if Slurm did not begin it again, is missing and no more.
missing=$("$program" sweep --status --json --out "$sent" |
    python3 -c 'import json, sys; s = json.load(sys.stdin); print(s["stages"] - s["stored"])')
if [ "$missing" -gt 0 ]; then
    "$program" sweep "${sweep[@]}" --slurm --time 00:10:00 --out "$sent"
    drained 300
fi
cmp "$folder/local/sweep.csv" "$sent/sweep.csv" ||
    fail "the sweep on Slurm is not the local one"
compgen -G "$sent/slurm/pluvia-collect-*.log" >/dev/null ||
    fail "the logs are not where they should be; see $sent/slurm"
echo '24 runs through Slurm with a node killed: the same table as without'

# A stage that takes longer than its limit of one minute is reported before it ends,
# and goes on from its checkpoint when it is submitted again.
long=("$scenario" --over contact.restitution=0.2 --set stages.2.duration_s=600
    --set grains.total_mass_g=120)
"$program" sweep "${long[@]}" --slurm --time 00:01:00 --out "$folder/long"
drained 300
"$program" sweep --status --out "$folder/long"
grep -q stopped "$folder"/long/slurm/pluvia-2-*.log ||
    fail "the stage over its limit was not told; see $folder/long/slurm"
"$program" sweep "${long[@]}" --slurm --time 00:20:00 --out "$folder/long"
drained 900
"$program" sweep --status --out "$folder/long" | tee "$folder/long.txt"
grep -q '1 of 1 run complete' "$folder/long.txt" || fail "the stage over its limit was not finished"
echo 'a stage over its time limit was stopped, submitted again and finished'
