#!/usr/bin/env bash
# Makes one engine ready that `make bench-peers` compares with:
#
#   scripts/peers.sh bullet|bullet-single|mujoco|pybullet|yade|blender
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

fail() {
    printf '%s\n' "$1" >&2
    exit 1
}

# Its own words go to a log: what is shown is one line.
log="$workshop/$1.install.log"
mkdir -p "$workshop"
: >"$log"

debian() {
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
    "$python" -c "import $1" >/dev/null 2>&1 && return 0
    echo "Installing $1 $2" >&2
    # Building from source takes longer than the comparison.
    "$python" -m pip install -q --only-binary :all: "$1==$2" numpy >>"$log" 2>&1 ||
        fail "pip could not install $1 $2: $(tail -1 "$log")"
    "$python" -c "import $1" >>"$log" 2>&1 || fail "$1 cannot be loaded: $(tail -1 "$log")"
}

bare_bullet() { # name of the library for pkg-config, and of the program
    local program="$workshop/$1" source=benches/peers/bullet.cpp
    if [ "$program" -nt "$source" ] && [ "$program" -nt benches/peers/json.h ]; then
        return 0
    fi
    pkg-config --exists "$1" || fail "pkg-config does not know $1; Debian has it in libbullet-dev"
    # shellcheck disable=SC2046
    g++ -O3 -std=c++17 $(pkg-config --cflags "$1") "$source" -o "$program" \
        $(pkg-config --libs "$1") >>"$log" 2>&1 || fail "bare Bullet does not compile: see $log"
}

case "$1" in
bullet) bare_bullet bullet-float64 ;;
bullet-single) bare_bullet bullet ;;
mujoco) python_package mujoco "$mujoco" ;;
pybullet) python_package pybullet "$pybullet" ;;
yade) debian yade ;;
blender) debian blender ;;
*) fail "scripts/peers.sh knows no engine '$1'" ;;
esac
