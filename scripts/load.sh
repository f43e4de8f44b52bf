#!/usr/bin/env bash
# Carries out scenarios/load/GRAINS-grains.json and holds its peak memory against
# a limit: load.sh GRAINS LIMIT_MIB OUT [arguments of `pluvia run`].
set -euo pipefail

grains=$1 limit_mib=$2 out=$3
shift 3
scenario=scenarios/load/$grains-grains.json
if [ ! -f "$scenario" ]; then
    echo "error: GRAINS=$grains, there are: $(ls scenarios/load | tr '\n' ' ')" >&2
    exit 2
fi

began=$(date +%s)
target/release/pluvia run "$scenario" --out "$out" "$@" &
run=$!
# An interrupt is for the run, which stops where it can go on.
trap 'kill -INT $run 2> /dev/null' INT TERM
peak_kib=0
while kill -0 $run 2> /dev/null; do
    # The system keeps the peak itself.
    now=$(sed -n 's/^VmHWM:[^0-9]*\([0-9]*\).*/\1/p' "/proc/$run/status" 2> /dev/null || true)
    peak_kib=${now:-$peak_kib}
    sleep 0.2
done
wait $run
peak_mib=$((peak_kib / 1024))
echo "load: $grains grains, $(($(date +%s) - began)) s, peak memory $peak_mib MiB, allowed $limit_mib MiB"
if [ "$peak_mib" -eq 0 ] || [ "$peak_mib" -gt "$limit_mib" ]; then
    echo "error: it took more memory than allowed, or the system did not tell" >&2
    exit 1
fi
