#!/usr/bin/env bash
# What a sweep costs beside its runs: 24 tiny runs as processes of their own, two
# at a time, and the same 24 as one sweep, in turn, several rounds. The runs share
# no stage (another seed makes other grains), so that sharing hides nothing.
#
#   sweep-overhead.sh [ROUNDS]     3 rounds unless given; about half a minute each
#
# PLUVIA is the program, target/release/pluvia unless given; CORES the two cores,
# as taskset has them. Prints wall time and CPU time of both and their ratio, and
# what the sweep's wall time is over that of its stages alone.
set -euo pipefail
# Times have a point in every locale.
export LC_ALL=C
cd "$(dirname "$0")/.."

program=$(realpath "${PLUVIA:-target/release/pluvia}")
rounds=${1:-3}
cores=${CORES:-0,1}
folder=$PWD/target/sweep-overhead
scenario=(scripts/tiny.json --set rest_test_s=0)
seeds=$(seq 1 24)

mkdir -p "$folder"

bare() {
    # shellcheck disable=SC2086
    printf '%s\n' $seeds | taskset -c "$cores" xargs -P2 -I{} \
        "$program" run "${scenario[@]}" --seed {} --quiet --out "$folder/bare/{}" >/dev/null
}

sweep() {
    taskset -c "$cores" "$program" sweep "${scenario[@]}" --over "seed=$(echo $seeds | tr ' ' ,)" \
        --jobs 2 --quiet --out "$folder/sweep" >/dev/null
}

# Wall time, user time and system time of a command, in s.
timed() {
    local TIMEFORMAT='%R %U %S'
    { time "$@" 2>/dev/null; } 2>&1
}

: >"$folder/times"
for round in $(seq "$rounds"); do
    # Who goes first changes from round to round.
    order='bare sweep'
    [ $((round % 2)) = 1 ] || order='sweep bare'
    for which in $order; do
        rm -rf "${folder:?}/$which"
        took=$(timed "$which") || {
            echo "error: round $round, $which: a run failed; see $folder/$which" >&2
            exit 1
        }
        printf '%s %s %s\n' "$round" "$which" "$took" >>"$folder/times"
    done
done

python3 - "$folder" <<'PYTHON'
import csv, statistics, sys
folder = sys.argv[1]
rows = {}
for line in open(folder + "/times"):
    round_, which, wall, user, system = line.split()
    rows.setdefault(which, []).append((float(wall), float(user) + float(system)))
print("round  bare wall  sweep wall  ratio  bare CPU  sweep CPU  ratio   (s)")
for n, (bare, sweep) in enumerate(zip(rows["bare"], rows["sweep"]), 1):
    print(f"{n:5}  {bare[0]:9.2f}  {sweep[0]:10.2f}  {sweep[0] / bare[0]:5.3f}"
          f"  {bare[1]:8.2f}  {sweep[1]:9.2f}  {sweep[1] / bare[1]:5.3f}")
median = lambda which, n: statistics.median(r[n] for r in rows[which])
wall, cpu = (median("sweep", n) / median("bare", n) for n in (0, 1))
print(f"sweep over bare runs, medians: wall {wall:.3f}, CPU {cpu:.3f} (asked: wall at most 1.10)")
stages = sum(float(r["wall_s"]) for r in csv.DictReader(open(folder + "/sweep/sweep-times.csv")))
last = rows["sweep"][-1][0]
print(f"last sweep: {last:.2f} s, its stages on two cores {stages / 2:.2f} s, "
      f"ratio {last / (stages / 2):.3f}")
PYTHON
