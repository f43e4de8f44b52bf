#!/bin/bash
# Builds the documentation as a site in out/site/, with MkDocs from PyPI in target/mkdocs/.
# Warnings, as of links and anchors that lead nowhere, are errors.
set -eu
cd "$(dirname "$0")/.."

venv=target/mkdocs
if ! "$venv/bin/mkdocs" --version >/dev/null 2>&1; then
    mkdir -p target
    if ! python3 -m venv "$venv"; then
        echo "error: python3 cannot make an environment; install python3-venv" >&2
        exit 2
    fi
    "$venv/bin/pip" install --quiet --only-binary :all: \
        'mkdocs==1.6.*' 'mkdocs-material==9.*' 'pymdown-extensions>=10'
fi
NO_MKDOCS_2_WARNING=1 "$venv/bin/mkdocs" build --strict "$@"
echo "the site is in out/site/index.html"
