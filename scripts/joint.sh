#!/usr/bin/env bash
# Shakes specimens under what the paper's text leaves open, and asks which values meet its four
# numbers together: joint.sh OUT TABLES BATCHES. Each batch draws eight points anew (its number
# is the seed) and shakes each continuously and intermittently, with and without a ramp, at full
# size; the mean of a few smaller piles, each another realisation, gives the angle of repose. Rows go to
# TABLES as they are found, in one file an experiment and batch; a batch that stands there is not
# run again. TABLES/builds.csv says which build made each file: rows of different builds are not
# pooled.
set -euo pipefail

out=$1 tables=$2 batches=$3
program=${PLUVIA:-target/release/pluvia}
studies=scenarios/studies/joint
mkdir -p "$tables"

# Friction from below what calibration finds for these piles (docs/repose.md) to above the paper's.
ranges=(--range contact.grain_grain_friction=0.25..0.9 --range grains.cells.relaxation_steps=0..3)
shaking=(--range stages.3.amplitude_mm=20..36 --range stages.3.crank_to_rod=0.01..0.3
    --range stages.2.placement=1..1000)

# A single pile is off by about two degrees.
piles=4

# The number of this build: it rises whenever results change.
format=$("$program" info --json | sed -n 's/.*"stage_format": \([0-9]*\).*/\1/p')
if [ -z "$format" ]; then
    echo "error: $program does not say its stage_format (pluvia info --json)" >&2
    exit 1
fi
builds=$tables/builds.csv
[ -e "$builds" ] || echo "table,format" > "$builds"

# format_of NAME: of the build that made a table. One that is not known is nobody else's.
format_of() {
    awk -F, -v name="$1" '
        $1 == name { of = $2 }
        END { print of == "" ? "unknown (" name ")" : of }' "$builds"
}

# Every table to be pooled, those that are made now among them, with its build.
pooled() {
    local table name batch
    for table in "$tables"/*-*.csv; do
        [ -e "$table" ] || continue
        name=$(basename "$table" .csv)
        echo "format $(format_of "$name"): $table"
    done
    for batch in $(seq 1 "$batches"); do
        for name in pile continuous intermittent; do
            table=$tables/$name-$batch.csv
            [ -e "$table" ] || echo "format $format: $table, to be made"
        done
    done
}

if [ "$(pooled | cut -d : -f 1 | sort -u | wc -l)" -gt 1 ]; then
    {
        echo "error: rows of different builds are not pooled; move tables away, or name another"
        echo "folder for them (make joint TABLES=DIR):"
        pooled
    } >&2
    exit 1
fi

# One row a point: the mean angle of its piles that count. Texts that may hold commas come last.
means() {
    LC_ALL=C awk -F, -v factors="contact.grain_grain_friction grains.cells.relaxation_steps" \
        -v angle="angle_of_repose.degrees" '
        BEGIN { count = split(factors, factor, " ") }
        NR == 1 {
            for (i = 1; i <= NF; i++) at[$i] = i
            line = "run,point,configuration"
            for (i = 1; i <= count; i++) line = line "," factor[i]
            print line "," angle ",piles"
            next
        }
        $at[angle] != "" && $at["left_out_of_means"] == "" {
            point = $at["point"]
            if (!(point in piles)) {
                order[++points] = point
                line = point "-c1," point ",1"
                for (i = 1; i <= count; i++) line = line "," $at[factor[i]]
                begun[point] = line
            }
            piles[point]++
            sum[point] += $at[angle]
        }
        END {
            for (i = 1; i <= points; i++) {
                point = order[i]
                printf "%s,%.6f,%d\n", begun[point], sum[point] / piles[point], piles[point]
            }
        }'
}

# sweep NAME BATCH SCENARIO ARGUMENTS...
sweep() {
    local name=$1 batch=$2 scenario=$3
    shift 3
    local table="$tables/$name-$batch.csv" rows=cat
    [ -e "$table" ] && return
    [ "$name" = pile ] && rows=means
    "$program" sweep "$scenario" --seed "$batch" --samples "latin-hypercube:8" "$@" \
        --out "$out/$name-$batch"
    $rows < "$out/$name-$batch/sweep.csv" > "$table.partial"
    echo "$name-$batch,$format" >> "$builds"
    mv "$table.partial" "$table"
}

for batch in $(seq 1 "$batches"); do
    sweep pile "$batch" scenarios/quick/repose.json "${ranges[@]}" --configurations "$piles"
    for name in continuous intermittent; do
        sweep "$name" "$batch" "$studies/$name.json" "${ranges[@]}" "${shaking[@]}" \
            --over stages.3.ramp_s=0,1
    done
done

runs=()
for table in "$tables"/*-*.csv; do
    name=$(basename "$table")
    runs+=(--runs "${name%-*}=$table")
done
# 38.40 degrees to within 2, which is ours: a single pile scatters by as much. The others as in
# claims.json.
"$program" targets "${runs[@]}" --out "$out/targets" --chance stages.2.placement \
    --target 'pile:angle_of_repose.degrees=36.4..40.4' \
    --target 'continuous:settlement_mm.final=14..19.61' \
    --target 'continuous:settlement_mm.after_5_s/settlement_mm.final=75..85' \
    --target 'intermittent:settlement_mm.after_each_period.0/settlement_mm.final=80..90'
cp "$out/targets/targets.json" "$tables/targets.json"
