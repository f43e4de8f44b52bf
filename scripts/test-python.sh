#!/usr/bin/env bash
# Installs the wheel of `make wheel` in a fresh environment, target/python/, and runs the package's
# tests and notebooks there. Words behind it go to pytest.
set -euo pipefail
cd "$(dirname "$0")/.."

fail() {
    printf 'error: %s. Try: %s\n' "$1" "$2" >&2
    exit 1
}

wheel=$(ls dist/pluvia-*.whl 2>/dev/null | head -1) || true
[ -n "$wheel" ] || fail "there is no wheel in dist/" "make wheel"
root=$PWD
rm -rf target/python
mkdir -p target/python
python3 -m venv target/python/venv || fail "python3 cannot make an environment" "bash scripts/setup.sh venv"
target/python/venv/bin/pip install --quiet --only-binary :all: "$root/$wheel[test]"
# Beside the sources the package that is found would be theirs.
cd target/python
export PLUVIA_INSTALLED=1
venv/bin/mypy --config-file "$root/python/pyproject.toml" --cache-dir mypy -p pluvia
venv/bin/pytest -c "$root/python/pyproject.toml" --rootdir "$root/python" -p no:cacheprovider "$root/python/tests" "$@"
