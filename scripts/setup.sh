#!/usr/bin/env bash
# Installs the Debian packages that the build needs and that are missing.
#
#   scripts/setup.sh        what building and running needs
#   scripts/setup.sh lint   also what `make lint` needs
#   scripts/setup.sh browser  also Chromium, in which the page of `pluvia view`
#                           is tested; without one that test is left out
#   scripts/setup.sh exports   also what `make test-exports` needs
#   scripts/setup.sh venv   also what a Python environment of its own needs
#   scripts/setup.sh valgrind  also valgrind
#   scripts/setup.sh slurm  also what `make test-slurm` needs
#   scripts/setup.sh referee  also what `make referee` needs
#   scripts/setup.sh soak   also strace and ext4's tools, without which `make soak`
#                           skips the classes that need them
#   scripts/setup.sh package  also what `make deb` and `make archive` need
#   scripts/setup.sh bare   also what `make test-deb` and `make test-wheel` need
#   scripts/setup.sh snakemake   also what `make test-snakemake` needs
#
# Several of these words may stand together.
#
# Says nothing and changes nothing when all is there, so that every make
# target can call it. What cannot be fixed ends with one sentence and one
# command to type.
set -euo pipefail

# rustup's folder, for shells that were open before Rust was installed.
PATH="$PATH:${CARGO_HOME:-${HOME:-/root}/.cargo}/bin"

fail() {
    printf 'error: %s. Try: %s\n' "$1" "$2" >&2
    exit 1
}

have() {
    command -v "$1" >/dev/null 2>&1
}

# bindgen loads libclang.so at build time and needs Clang's own headers, which
# come with the same package.
have_libclang() {
    [ -n "${LIBCLANG_PATH:-}" ] && return 0
    local library
    for library in /usr/lib/llvm-*/lib/libclang.so /usr/lib/libclang.so /usr/lib64/libclang.so \
        /usr/lib/*/libclang.so /usr/local/lib/libclang.so; do
        [ -e "$library" ] && return 0
    done
    return 1
}

# Both libraries are asked for: the default build links the double precision
# one, `--no-default-features` the single precision one.
have_bullet() {
    have pkg-config && pkg-config --exists bullet bullet-float64
}

have_chromium() {
    have chromium || have chromium-browser || have google-chrome || have google-chrome-stable
}

asked=" $* "
wanted() {
    [[ $asked == *" $1 "* ]]
}

get_rust="curl --proto '=https' --tlsv1.2 -sSf https://sh.rustup.rs | sh -s -- -y"
# What an older one says of it names no version.
needed=$(sed -n 's/^rust-version = "\(.*\)"$/\1/p' "$(dirname "$0")/../Cargo.toml" | head -1)
if have cargo; then
    found=$(cargo --version 2>/dev/null | sed 's/^cargo \([0-9.]*\).*/\1/') || true
    newer="rustup update stable"
    # Debian's has no rustup, and would stand before that of rustup in this shell.
    have rustup || newer="$get_rust && . \"${CARGO_HOME:-\$HOME/.cargo}/env\""
    printf '%s\n%s\n' "$needed" "$found" | sort -C -V || fail \
        "cargo is ${found:-there without a compiler}, and Pluvia needs $needed or newer" "$newer"
fi

missing=()
have g++ || missing+=(g++)
have make || missing+=(make)
have pkg-config || missing+=(pkg-config)
have_bullet || missing+=(libbullet-dev)
have_libclang || missing+=(libclang-dev)
if wanted lint; then
    have clang-format || missing+=(clang-format)
fi
if wanted browser && ! have_chromium; then
    missing+=(chromium)
fi
if wanted exports || wanted snakemake || wanted venv || wanted referee; then
    python3 -c 'import ensurepip, venv' >/dev/null 2>&1 || missing+=(python3 python3-venv)
fi
if wanted referee; then
    [ -e /usr/include/siconos/numerics/fc3d_Solvers.h ] || missing+=(libsiconos-numerics-dev)
    [ -e /usr/include/suitesparse/umfpack.h ] || missing+=(libsuitesparse-dev)
    [ -e /usr/include/eigen3/Eigen/Dense ] || missing+=(libeigen3-dev)
    [ -e /usr/include/nlohmann/json.hpp ] || missing+=(nlohmann-json3-dev)
fi
if wanted valgrind; then
    have valgrind || missing+=(valgrind)
fi
if wanted soak; then
    have strace || missing+=(strace)
    have mkfs.ext4 || [ -x /sbin/mkfs.ext4 ] || missing+=(e2fsprogs)
    have python3 || missing+=(python3)
fi
if wanted package; then
    have dpkg-shlibdeps || missing+=(dpkg-dev)
    have xz || missing+=(xz-utils)
    have python3 || missing+=(python3)
fi
if wanted bare; then
    have debootstrap || missing+=(debootstrap)
fi
if wanted exports; then
    have node && have npm || missing+=(nodejs npm)
fi

if wanted slurm; then
    have slurmctld && have slurmd || missing+=(slurm-wlm)
    have munged || missing+=(munge)
    have python3 || missing+=(python3)
fi

if [ ${#missing[@]} -gt 0 ]; then
    have apt-get || fail \
        "missing here: ${missing[*]} (Debian's names), and there is no apt-get to install them with" \
        "docker run --rm -it -v \"\$PWD\":/pluvia -w /pluvia rust:bookworm make test"
    root=()
    if [ "$(id -u)" -ne 0 ]; then
        have sudo || fail \
            "missing here: ${missing[*]}; installing them needs root, and there is no sudo" \
            "su -c 'apt-get update && apt-get install -y ${missing[*]}'"
        root=(sudo)
    fi
    echo "Installing ${missing[*]}"
    if ! { "${root[@]}" apt-get update -q &&
        "${root[@]}" env DEBIAN_FRONTEND=noninteractive \
            apt-get install -q -y --no-install-recommends "${missing[@]}"; }; then
        fail "apt-get could not install ${missing[*]} (its own message is above)" \
            "${root[*]:+sudo }apt-get install ${missing[*]}"
    fi
    have_bullet || fail \
        "libbullet-dev is installed, but pkg-config does not know both bullet and bullet-float64" \
        "pkg-config --print-errors --exists bullet bullet-float64"
fi

have cargo || fail \
    "cargo, Rust's build tool, was not found" "$get_rust"

if wanted lint; then
    # rustup leaves a stand-in where a component is missing: only running tells.
    works() { cargo "$1" --version >/dev/null 2>&1; }
    works fmt || { have rustup && rustup component add rustfmt; } || fail \
        "cargo fmt, which checks the formatting, was not found" "rustup component add rustfmt"
    works clippy || { have rustup && rustup component add clippy; } || fail \
        "cargo clippy, which checks the source, was not found" "rustup component add clippy"
fi
