#!/usr/bin/env bash
# Makes one engine ready that `make bench-peers` compares with:
#
#   scripts/peers.sh bullet|bullet-single|box3d|box3d-patched|mujoco|pybullet|yade|blender
#
# Says nothing when all is there. What cannot be had ends with one line that
# says why; nothing here is needed to build or use Pluvia itself.
set -euo pipefail
cd "$(dirname "$0")/.."

workshop=target/peers
python="$workshop/venv/bin/python"
# Those that were tried; `docs/peers.md` tells of their settings.
mujoco=4.0.0
pybullet=3.2.7
box3d=0.1.16 # the crate box3d-sys, which has Box3D 0.1.0
box3d_patch=benches/peers/box3d-boxes.patch

fail() {
    printf '%s\n' "$1" >&2
    exit 1
}

# Its own words go to a log: what is shown is one line.
log="$workshop/$1.install.log"
mkdir -p "$workshop"
: >"$log"

debian() { # package, which holds a program of the same name
    command -v "$1" >/dev/null 2>&1 && return 0
    command -v apt-get >/dev/null 2>&1 || fail "$1 is missing, and there is no apt-get to install it with"
    local root=()
    if [ "$(id -u)" -ne 0 ]; then
        command -v sudo >/dev/null 2>&1 || fail "$1 is missing; installing it needs root, and there is no sudo"
        root=(sudo)
    fi
    echo "Installing $1" >&2
    { "${root[@]}" apt-get update -q && "${root[@]}" env DEBIAN_FRONTEND=noninteractive \
        apt-get install -q -y --no-install-recommends "$1"; } >>"$log" 2>&1 ||
        fail "apt-get could not install $1: $(grep '^E:' "$log" | tail -1)"
}

python_package() { # name version
    if [ ! -x "$python" ]; then
        command -v python3 >/dev/null 2>&1 || fail "there is no python3"
        python3 -m venv "$workshop/venv" >>"$log" 2>&1 ||
            fail "python3 cannot make a virtual environment; Debian has it in python3-venv"
    fi
    local found
    found=$("$python" -c "import $1; from importlib.metadata import version; print(version('$1'))" \
        2>/dev/null | tail -1) || true
    [ "$found" != "$2" ] || return 0
    echo "Installing $1 $2${found:+ in place of $found}" >&2
    # Building from source takes longer than the comparison.
    "$python" -m pip install -q --only-binary :all: "$1==$2" numpy >>"$log" 2>&1 ||
        fail "pip could not install $1 $2: $(tail -1 "$log")"
    "$python" -c "import $1" >>"$log" 2>&1 || fail "$1 cannot be loaded: $(tail -1 "$log")"
}

stock_bullet() { # name of the library for pkg-config, and of the program
    local program="$workshop/$1" source=benches/peers/bullet.cpp
    if [ "$program" -nt "$source" ] && [ "$program" -nt benches/peers/json.h ] &&
        [ "$program" -nt benches/peers/peer.h ]; then
        return 0
    fi
    pkg-config --exists "$1" || fail "pkg-config does not know $1; Debian has it in libbullet-dev"
    # shellcheck disable=SC2046
    g++ -O3 -std=c++17 $(pkg-config --cflags "$1") "$source" -o "$program" \
        $(pkg-config --libs "$1") >>"$log" 2>&1 || fail "stock Bullet does not compile: see $log"
}

# The C source comes with a crate, which cargo checks; it is built as its makers build it.
box3d() { # name of the program: box3d or box3d-patched
    local program="$workshop/$1" build="$PWD/$workshop/$1-build" crate
    local sources=(scripts/peers.sh benches/peers/{box3d.cpp,peer.h,json.h})
    [ "$1" = box3d ] || sources+=("$box3d_patch")
    # Says something where one is newer, or there is no program.
    [ -n "$(find "${sources[@]}" -newer "$program" 2>&1)" ] || return 0
    debian cmake
    [ "$1" = box3d ] || debian patch
    echo "Building $1" >&2
    rm -rf "$build"
    mkdir -p "$build"
    cat >"$build/Cargo.toml" <<-END
	[package]
	name = "source"
	version = "0.0.0"
	edition = "2024"
	[lib]
	path = "none.rs"
	[dependencies]
	box3d-sys = "=$box3d"
	[workspace]
	END
    touch "$build/none.rs"
    crate=$(cargo metadata --format-version 1 --manifest-path "$build/Cargo.toml" 2>>"$log" |
        grep -o "[^\"]*/box3d-sys-$box3d/Cargo.toml" | head -1) || true
    [ -n "$crate" ] || fail "cargo could not fetch box3d-sys $box3d: $(tail -1 "$log")"
    cp -r "${crate%/Cargo.toml}/vendor/box3d" "$build/source"
    if [ "$1" != box3d ]; then
        # Patches tell lines by their ends, and Box3D's have two characters.
        sed -i 's/\r$//' "$build/source/src/hull.c"
        patch -d "$build/source" -p1 <"$box3d_patch" >>"$log" 2>&1 ||
            fail "$box3d_patch does not fit Box3D: see $log"
    fi
    { cmake -S "$build/source" -B "$build/made" -DCMAKE_BUILD_TYPE=Release \
        -DBOX3D_SAMPLES=OFF -DBOX3D_UNIT_TESTS=OFF &&
        cmake --build "$build/made" --target box3d; } >>"$log" 2>&1 ||
        fail "Box3D does not compile: see $log"
    g++ -O3 -DNDEBUG -std=c++17 -I"$build/source/include" benches/peers/box3d.cpp -o "$program" \
        "$(find "$build/made" -name 'libbox3d*.a' | head -1)" -lm -pthread >>"$log" 2>&1 ||
        fail "the peer of Box3D does not compile: see $log"
}

case "$1" in
bullet) stock_bullet bullet-float64 ;;
bullet-single) stock_bullet bullet ;;
box3d | box3d-2-threads) box3d box3d ;;
box3d-patched | box3d-patched-2-threads) box3d box3d-patched ;;
mujoco) python_package mujoco "$mujoco" ;;
pybullet) python_package pybullet "$pybullet" ;;
yade) debian yade ;;
blender) debian blender ;;
*) fail "scripts/peers.sh knows no engine '$1'" ;;
esac
