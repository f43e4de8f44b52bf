#!/usr/bin/env bash
# Specimens under their plate with stock Bullet contacts, left alone for 20 s and shaken for as long,
# and left alone with native contacts; puts what docs/results/interpretations.md quotes of them into
# OUT/tables: at-rest.sh OUT [arguments of `pluvia sweep`].
set -euo pipefail
# Numbers have a point in every locale.
export LC_ALL=C

out=$1
shift
program=${PLUVIA:-target/release/pluvia}
scenario=scenarios/paper/vibration-continuous.json
common=(--configurations 3 --set rest_test_s=1)
"$program" sweep "$scenario" "${common[@]}" --out "$out/rest" \
    --over 'engine.contact_solver="stock","native"' \
    --set 'stages.3={"stage":"rest","duration_s":20}' "$@"
"$program" sweep "$scenario" "${common[@]}" --out "$out/shaken" \
    --over 'engine.contact_solver="stock"' "$@"

# Time since the fourth stage began, and what plate and mean surface have sunk since, of a run.
sunk() {
    awk -F, '
        NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
        $at["stage"] == 3 && $at["plate_height_mm"] != "" {
            t = $at["time_s"]; p = $at["plate_height_mm"]; s = $at["mean_surface_mm"]
            if (!seen++) { t0 = t; p0 = p; s0 = s }
            printf "%.9g %.9g %.9g\n", t - t0, p0 - p, s0 - s
        }' "$out/$1/series.csv"
}

# A column at some times, with this number of digits: on straight lines between the rows.
at() {
    awk -v times="$1" -v column="$2" -v digits="$3" '
        BEGIN { count = split(times, wanted, " "); n = 1 }
        {
            while (n <= count && wanted[n] <= $1) {
                share = $1 > before ? (wanted[n] - before) / ($1 - before) : 1
                text = sprintf("%." digits "f", value + share * ($column - value))
                if (text + 0 == 0) sub(/^-/, "", text)
                printf "%s%s", (n > 1 ? "," : ""), text
                n++
            }
            before = $1; value = $column
        }
        END { if (n <= count) { print "error: a run ends before " wanted[n] " s" > "/dev/stderr"; exit 1 } }'
}

tables=$out/tables
mkdir -p "$tables"
# Each value gets a line of its own: within an `echo` a failure of `at` would not end the script.
{
    echo "configuration,stock_rest_plate_after_5_s_mm,stock_rest_plate_after_20_s_mm,\
stock_rest_share_after_5_s_percent,stock_rest_surface_after_20_s_mm,stock_shaken_plate_after_5_s_mm,\
stock_shaken_plate_after_20_s_mm,stock_shaken_surface_after_20_s_mm,native_rest_plate_after_20_s_mm"
    for c in 1 2 3; do
        rest=$(sunk "rest/runs/point-0001-c$c")
        shaken=$(sunk "shaken/runs/point-0001-c$c")
        native=$(sunk "rest/runs/point-0002-c$c")
        plate=$(at "5 20" 2 4 <<<"$rest")
        share=$(awk -F, '{ printf "%.4f", 100 * $1 / $2 }' <<<"$plate")
        surface=$(at 20 3 4 <<<"$rest")
        shaken_plate=$(at "5 20" 2 4 <<<"$shaken")
        shaken_surface=$(at 20 3 4 <<<"$shaken")
        native_plate=$(at 20 2 4 <<<"$native")
        echo "$c,$plate,$share,$surface,$shaken_plate,$shaken_surface,$native_plate"
    done
} >"$tables/stock-at-rest.partial"

times=$(seq -s " " 0 0.4 20)
names=(stock_left_alone_c{1,2,3} stock_shaken_c{1,2,3} native_left_alone_c1)
runs=(rest/runs/point-0001-c{1,2,3} shaken/runs/point-0001-c{1,2,3} rest/runs/point-0002-c1)
columns=()
for name in "${names[@]}"; do columns+=("settlement_${name}_mm"); done
files=()
for n in "${!runs[@]}"; do
    file=$tables/${names[n]}.column
    sunk "${runs[n]}" | at "$times" 2 3 | tr ',' '\n' >"$file"
    echo >>"$file"
    files+=("$file")
done
{
    (IFS=, && echo "time_s,${columns[*]}")
    paste -d, <(tr ' ' '\n' <<<"$times") "${files[@]}"
} >"$tables/stock-at-rest-series.partial"
# Both tables or neither.
for table in stock-at-rest stock-at-rest-series; do
    mv "$tables/$table.partial" "$tables/$table.csv"
done
rm "$tables"/*.column
all=$(IFS=, && echo "${columns[*]}")
"$program" plot "$tables" --file stock-at-rest-series.csv --x time_s --y "$all" \
    --out "$tables/stock-at-rest.svg" --force
