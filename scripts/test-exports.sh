#!/usr/bin/env bash
# Has the programs that exports are made for read them back: VTK every .vtp and
# .pvd file, the Khronos validator every .glb file. What they need comes from
# PyPI and npm into target/exports/; nothing is installed elsewhere.
set -euo pipefail
cd "$(dirname "$0")/.."

fail() {
    printf 'error: %s. Try: %s\n' "$1" "$2" >&2
    exit 1
}

checks=$PWD/tests/exports
folder=$PWD/target/exports
program=${PLUVIA:-target/debug/pluvia}
mkdir -p "$folder/node"

python=$folder/python/bin/python
. scripts/pinned.sh
mapfile -t wanted <"$checks/requirements.txt"
pinned "$folder/python" "${wanted[@]}" ||
    fail "pip could not fetch VTK (the message is above); this test needs the network once" \
        "make test, which reads exports back without it"
if [ ! -d "$folder/node/node_modules/gltf-validator" ] ||
    ! cmp -s "$checks/package.json" "$folder/node/package.json"; then
    cp "$checks/package.json" "$folder/node/package.json"
    if ! (cd "$folder/node" && npm install --silent --no-audit --no-fund --no-package-lock); then
        rm "$folder/node/package.json"
        fail "npm could not fetch gltf-validator; this test needs the network once" \
            "make test, which reads exports back without it"
    fi
fi

[ -x "$program" ] || cargo build --locked
run=$folder/run
out=$folder/out
rm -rf "$out" "$run"
"$program" run "$checks/small.json" --quiet --out "$run"
"$program" export "$run" --format vtk --every 0.08 --out "$out/vtk"
"$program" export "$run" --format csv --stage vibrate --out "$out/csv"
"$program" export "$run" --format glb --out "$out/still"
"$program" export "$run" --format glb --animate --out "$out/moving"
"$program" export "$run" --format glb --stage fill_funnel --out "$out/filled"

"$python" "$checks/read_vtk.py" "$out/vtk" "$out/csv"
(cd "$folder/node" && node "$checks/validate_glb.mjs" \
    "$out/still/specimen.glb" "$out/moving/specimen.glb" "$out/filled/specimen.glb")
