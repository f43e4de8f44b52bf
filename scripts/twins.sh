#!/usr/bin/env bash
# Runs the scaled twins of scenarios/studies/twins.json and puts what docs/scale.md quotes of them
# into a table: twins.sh OUT TABLE [arguments of `pluvia sweep`].
set -euo pipefail

out=$1 table=$2
shift 2
program=${PLUVIA:-target/release/pluvia}
"$program" sweep --design scenarios/studies/twins.json --out "$out" "$@"

columns="void_ratio standing_height_mm.mean_surface coordination_number overlap.mean_percent \
overlap.p99_percent creep_um_per_s grains.left_in_funnel meets_standard valid"
# Texts that may hold commas or lines come last in a row. A run without result has no void ratio.
rows=$(awk -F, -v columns="size configuration $columns" '
    BEGIN { count = split(columns, wanted, " ") }
    NR == 1 {
        for (i = 1; i <= NF; i++) at[$i] = i
        for (i = 1; i <= count; i++) if (!(wanted[i] in at)) {
            print "error: sweep.csv has no column " wanted[i] > "/dev/stderr"
            exit 1
        }
        next
    }
    NF >= at["valid"] && $at["size"] + 0 > 0 && $at["configuration"] ~ /^[0-9]+$/ {
        row = $at[wanted[1]]
        for (i = 2; i <= count; i++) row = row "," $at[wanted[i]]
        print row
    }' "$out/sweep.csv" | LC_ALL=C sort -t, -k1,1g -k2,2n)
count() { echo "$rows" | awk -F, "$1 { n++ } END { print n + 0 }"; }
if [ "$(count '$3 != ""')" = 0 ]; then
    echo "error: no twin has a result; see $out/sweep.md" >&2
    exit 1
fi
{ echo "larger,configuration,${columns// /,}"; echo "$rows"; } > "$table.partial"
mv "$table.partial" "$table"
echo "$(count 1) runs in $table, $(count '$3 == "" || $NF != "true"') of them without result or not valid"
