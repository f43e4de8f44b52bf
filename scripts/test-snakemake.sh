#!/usr/bin/env bash
# A sweep of tiny runs run by Snakemake in a folder with blanks and
# quotes in its name: the same table, byte for byte, as without it; and after a
# stage is lost, or configurations are added, only what is missing is done.
set -euo pipefail
cd "$(dirname "$0")/.."

program=$(realpath "${PLUVIA:-target/debug/pluvia}")
folder=$PWD/target/snakemake
flow="$folder/it's a \"flow\" of 100 %"
moved="$folder/moved to another place"
scenario=$folder/small.json

fail() {
    printf 'error: %s\n' "$1" >&2
    exit 1
}

mkdir -p "$folder"
. scripts/pinned.sh
pinned "$folder/venv" snakemake==9.27.1 || fail "Snakemake could not be fetched (the message is above)"
rm -rf "$folder/local" "$flow" "$moved"
cp scripts/tiny.json "$scenario"
sweep=("$scenario" --over contact.grain_grain_friction=0.3,0.7
    --over stages.1.falling_height_mm=0,40 --set engine.rate_hz=240 --set stages.0.time_limit_s=1
    --set stages.1.time_limit_s=1.5 --set stages.2.duration_s=0.25 --set rest_test_s=0.25 --quiet)

# Runs a folder's Snakefile; says how many stages were stored by it.
carry_out() {
    touch "$folder/begun"
    (cd "$folder" && "$folder/venv/bin/snakemake" --cores 2 --snakefile "$1/Snakefile") \
        >"$folder/last.log" 2>&1 || fail "snakemake did not finish: $(cat "$folder/last.log")"
    # Snakemake touches what it looked at; what was stored has a new specimen.
    find "$1/stages" -name specimen.json -newer "$folder/begun" | wc -l
}

# Holds the number of stages that were run against what is expected.
expect() {
    [ "$2" = "$3" ] || fail "$1: $2 stages were run, expected $3; see $folder/last.log"
    printf '%s: %s stages\n' "$1" "$2"
}

same_table() {
    cmp "$folder/local/sweep.csv" "$1/sweep.csv" || fail "the table of $1 is not the local one"
}

# Two fillings, one a friction; then four each of pours, rests and rest tests.
"$program" sweep "${sweep[@]}" --out "$folder/local" >/dev/null
"$program" sweep "${sweep[@]}" --out "$flow" --snakemake >/dev/null
expect 'the whole sweep' "$(carry_out "$flow")" 14
same_table "$flow"
expect 'once more' "$(carry_out "$flow")" 0

# One stage each of a beginning, a middle and an end is lost, in turn.
for name in fill_funnel pour rest; do
    lost=$(grep -l "\"stage\": \"$name\"" "$flow"/stages/*/stage.json | head -n 1)
    rm -r "$(dirname "$lost")"
    expect "after a stage $name was lost" "$(carry_out "$flow")" 1
    same_table "$flow"
done

# The folder goes elsewhere, and the scenario's file is gone.
mv "$flow" "$moved"
mv "$scenario" "$folder/elsewhere.json"
rm -r "$moved/stages/$(ls "$moved/stages" | head -n 1)"
expect 'moved, a stage lost' "$(carry_out "$moved")" 1
same_table "$moved"
mv "$folder/elsewhere.json" "$scenario"

# More configurations: what is there stays.
"$program" sweep "${sweep[@]}" --configurations 2 --out "$folder/local" >/dev/null
"$program" sweep "${sweep[@]}" --configurations 2 --out "$moved" --snakemake >/dev/null
expect 'a second configuration' "$(carry_out "$moved")" 14
same_table "$moved"
echo 'Snakemake: the same table byte for byte, and only what was missing was run'
