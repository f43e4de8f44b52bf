#!/usr/bin/env bash
# Runs scenarios/load/GRAINS-grains.json and compares its peak memory, its time and what
# became of the grains with limits:
#
#   scripts/load.sh GRAINS LIMIT_MIB LIMIT_MINUTES OUT [arguments of `pluvia run`]
#
# Prints one line with all of it, and fails where a limit is exceeded, or where
# the specimen does not meet the accuracy standard (summary.json). PLUVIA is the
# program, target/release/pluvia unless given.
set -euo pipefail

grains=$1 limit_mib=$2 limit_minutes=$3 out=$4
shift 4
scenario=scenarios/load/$grains-grains.json
if [ ! -f "$scenario" ]; then
    echo "error: GRAINS=$grains, there are: $(ls scenarios/load | tr '\n' ' ')" >&2
    exit 2
fi
for limit in "LIMIT_MIB=$limit_mib" "LIMIT_MINUTES=$limit_minutes"; do
    if ! [[ ${limit#*=} =~ ^[1-9][0-9]*$ ]]; then
        echo "error: $limit, allowed are whole numbers from 1" >&2
        exit 2
    fi
done

began=$(date +%s)
"${PLUVIA:-target/release/pluvia}" run "$scenario" --out "$out" "$@" &
run=$!
# A signal is for the run, which stops where it can go on: at the second it would end at once. Ctrl-C
# at a terminal reaches it without this script, SIGTERM does not. Ctrl-C ends `sed` and `sleep`, too.
trap : INT
trap 'kill -TERM $run 2> /dev/null || true' TERM
peak_kib=0
while kill -0 $run 2> /dev/null; do
    # The system keeps the peak itself.
    now=$(sed -n 's/^VmHWM:[^0-9]*\([0-9]*\).*/\1/p' "/proc/$run/status" 2> /dev/null) || true
    peak_kib=${now:-$peak_kib}
    sleep 0.2 || true
done
wait $run
peak_mib=$((peak_kib / 1024))

# From the summary: whether the standard is met, and the figures that it is judged by.
field() { # name: the first of it
    sed -n "s/^ *\"$1\": *\([^,]*\),\{0,1\}$/\1/p" "$out/summary.json" | head -1
}
short() { # name: as the field, a number with three digits
    local value
    value=$(field "$1")
    [[ $value =~ ^-?[0-9] ]] && value=$(LC_ALL=C printf '%.3g' "$value")
    echo "$value"
}
standard=$(field meets_standard)
# A run that was resumed took longer than this time alone.
seconds=$(($(date +%s) - began)) in_all=$(field wall_s)
in_all=${in_all%.*}
[[ $in_all =~ ^[0-9]+$ ]] && [ "$in_all" -gt "$seconds" ] && seconds=$in_all
case $standard in
true) said="standard met" ;;
false) said="standard missed" ;;
*) said="standard not known" ;;
esac
echo "load: $grains grains, $seconds s of $((60 * limit_minutes)) s, peak memory $peak_mib MiB of" \
    "$limit_mib MiB, $said: overlap $(short mean_percent) / $(short p99_percent) % (mean /" \
    "99th percentile), numerical creep $(short creep_um_per_s) µm/s, void ratio $(short void_ratio)"

missed=0
miss() {
    echo "error: $1" >&2
    missed=1
}
if [ "$peak_kib" -eq 0 ] || [ "$peak_kib" -gt $((1024 * limit_mib)) ]; then
    miss "it took more memory than LIMIT_MIB=$limit_mib, or the system did not tell"
fi
if [ "$seconds" -gt $((60 * limit_minutes)) ]; then
    miss "it took $seconds s, more than LIMIT_MINUTES=$limit_minutes"
fi
if [ "$standard" != true ]; then
    miss "meets_standard in $out/summary.json is ${standard:-missing}"
fi
exit $missed
