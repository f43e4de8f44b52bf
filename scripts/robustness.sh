#!/usr/bin/env bash
# Makes docs/results/robustness.json, and the table of docs/robustness.md, from the log of a soak.
#
#   make soak MINUTES=60
#   scripts/robustness.sh [LOG]     by default target/tmp/soak.jsonl
set -euo pipefail
cd "$(dirname "$0")/.."
log=${1:-target/tmp/soak.jsonl}
if [ ! -s "$log" ]; then
    printf 'error: there is no log %s. Try: make soak MINUTES=60\n' "$log" >&2
    exit 1
fi
PLUVIA_SOAK_LOG=$log cargo test --locked --release --test it -- \
    --exact soak::page::the_page_has_the_counts_of_the_logged_soak
