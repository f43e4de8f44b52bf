#!/bin/bash
# Builds the documentation as a site in out/site/, with MkDocs from PyPI in target/mkdocs/.
# Warnings, as of links and anchors that lead nowhere, are errors.
set -eu
cd "$(dirname "$0")/.."

. scripts/pinned.sh
venv=target/mkdocs
mkdir -p target
if ! PIP_ONLY_BINARY=:all: pinned "$venv" 'mkdocs==1.6.*' 'mkdocs-material==9.*' 'pymdown-extensions>=10'; then
    echo "error: MkDocs could not be installed (the message is above); it needs python3-venv and the network" >&2
    exit 2
fi
NO_MKDOCS_2_WARNING=1 "$venv/bin/mkdocs" build --strict "$@"
echo "the site is in out/site/index.html"
