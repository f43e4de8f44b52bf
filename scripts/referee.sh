#!/usr/bin/env bash
# Builds the referee's own program into target/referee, with its Python
# environment, and has it check itself. `make referee` calls it; nothing here is
# needed to build or use Pluvia.
set -euo pipefail
cd "$(dirname "$0")/.."

source=benches/referee
workshop=target/referee
# Of the solver of convex problems.
clarabel=0.11.1

fail() {
    printf 'error: %s\n' "$1" >&2
    exit 1
}

bash scripts/setup.sh referee
mkdir -p "$workshop"

# The same bits in every build of the same machine type, as for Bullet's side.
# GCC 12 takes vector loads in Eigen for reads beyond the end: -Wno-array-bounds.
flags=(-std=c++17 -O3 -march=native -ffp-contract=off -Wall -Wextra -Wno-array-bounds
    -isystem /usr/include/eigen3 -isystem /usr/include/suitesparse
    -isystem /usr/include/siconos -isystem /usr/include/siconos/numerics)
for file in "$source"/*.cpp; do
    object="$workshop/$(basename "$file" .cpp).o"
    newer=$(find "$source" -name '*.h' -newer "$object" 2>/dev/null || echo none)
    if [ ! -e "$object" ] || [ "$file" -nt "$object" ] || [ -n "$newer" ]; then
        echo "Compiling $file"
        g++ "${flags[@]}" -c "$file" -o "$object" || fail "$file does not compile"
    fi
done
g++ "$workshop"/*.o -o "$workshop/referee" -lumfpack -lsiconos_numerics ||
    fail "the referee does not link"

python="$workshop/venv/bin/python"
. scripts/pinned.sh
PIP_ONLY_BINARY=:all: pinned "$workshop/venv" "clarabel==$clarabel" ||
    fail "pip could not install clarabel $clarabel"

# Siconos tells on stderr of what it tries.
"$workshop/referee" check 2>/dev/null || fail "the referee fails its own checks"
if [ -e "$source/certificate.py" ]; then
    "$python" "$source/certificate.py" check || fail "the certificate fails its own checks"
fi
