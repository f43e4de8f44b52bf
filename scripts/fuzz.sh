#!/usr/bin/env bash
# Feeds the readers of fuzz/targets.rs by coverage, with libFuzzer and
# AddressSanitizer, for a number of minutes in all.
#
#   scripts/fuzz.sh 10             ten minutes, shared by all targets
#   scripts/fuzz.sh 10 mesh        for one of them
#   scripts/fuzz.sh keep           puts what is worth keeping of all that was found
#                                  into fuzz/corpus/, which every test run reads
#
# What is found grows in target/fuzz/; an input that fails stays in
# fuzz/artifacts/. The compiler in use does it: RUSTC_BOOTSTRAP lets a stable
# one take the flags that it needs.
set -euo pipefail
cd "$(dirname "$0")/.."
export RUSTC_BOOTSTRAP=1

fail() {
    printf 'error: %s. Try: %s\n' "$1" "$2" >&2
    exit 1
}

folder=$PWD/target/fuzz
# Files of a kept corpus, and bytes of each: enough to begin with, few enough to
# be read in every test run.
most_files=60
most_bytes=2048

PATH="$PATH:$folder/tools/bin"
if ! cargo fuzz --version >/dev/null 2>&1; then
    cargo install --locked --root "$folder/tools" cargo-fuzz ||
        fail "cargo-fuzz could not be compiled (the message is above)" \
            "cargo install --locked cargo-fuzz"
fi
# The targets of fuzz/Cargo.toml.
listed=$(cargo fuzz list) || fail "cargo-fuzz cannot list its targets" "cargo fuzz list"
mapfile -t targets <<<"$listed"
# The same crates as are linked otherwise: cargo adds those of fuzzing alone.
[ fuzz/Cargo.lock -nt Cargo.lock ] || cp Cargo.lock fuzz/Cargo.lock
mkdir -p "$folder/tmp"
export TMPDIR=$folder/tmp

one() {
    local target=$1 seconds=$2
    mkdir -p "$folder/corpus/$target"
    # shellcheck disable=SC2310
    cargo fuzz run "$target" "$folder/corpus/$target" "fuzz/corpus/$target" -- \
        -max_total_time="$seconds" -max_len=65536 -timeout=20 -rss_limit_mb=4096 \
        -print_final_stats=1 >"$folder/$target.txt" 2>&1 ||
        fail "an input for $target fails, and is in fuzz/artifacts/$target/" \
            "tail -50 $folder/$target.txt"
    local units places
    units=$(sed -n 's/^stat::number_of_executed_units: *\([0-9]*\)/\1/p' "$folder/$target.txt")
    [ "${units:-0}" -gt 0 ] ||
        fail "libFuzzer does not say that it tried an input for $target" "tail -50 $folder/$target.txt"
    places=$(sed -n 's/.* cov: \([0-9]*\) .*/\1/p' "$folder/$target.txt" | tail -1)
    echo "fuzz, $target: $units inputs in $seconds s, all read or refused, $places places reached"
}

# Of the inputs that together reach every place, some of every size: the smallest
# alone would be hardly more than empty.
keep() {
    local target=$1 least=$folder/least/$1
    rm -rf "$least"
    mkdir -p "$least" "$folder/corpus/$target"
    cargo fuzz run "$target" "$least" "fuzz/corpus/$target" "$folder/corpus/$target" -- \
        -set_cover_merge=1 -max_len=65536 -timeout=20 >"$folder/$target-least.txt" 2>&1 ||
        fail "the corpus of $target cannot be merged" "tail -50 $folder/$target-least.txt"
    find "$least" -type f -size -${most_bytes}c -printf '%s %p\n' | sort -n |
        awk -v most="$most_files" '{ line[NR] = $0 }
            END { n = NR < most ? NR : most
                for (i = 1; i <= n; ++i) print line[int((i - 0.5) * NR / n) + 1] }' |
        while read -r _ file; do
        cp -n "$file" "fuzz/corpus/$target/found-$(basename "$file" | cut -c1-12)"
    done
    echo "fuzz, $target: $(find "fuzz/corpus/$target" -type f | wc -l) inputs kept"
}

if [ "${1:-}" = keep ]; then
    for target in "${targets[@]}"; do keep "$target"; done
    exit
fi
minutes=${1:-10}
[ $# -lt 2 ] || targets=("${@:2}")
seconds=$(LC_ALL=C awk -v minutes="$minutes" -v targets="${#targets[@]}" \
    'BEGIN { print int(60 * minutes / targets) }')
[ "$seconds" -gt 0 ] || fail "there is no time for $minutes minutes" "make fuzz MINUTES=10"
cargo fuzz build
for target in "${targets[@]}"; do one "$target" "$seconds"; done
