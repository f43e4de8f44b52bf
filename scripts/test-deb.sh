#!/usr/bin/env bash
# Installs the package that `make deb` made on a bare Debian 12, and runs the program there.
#
# Makes the bare system with debootstrap in target/package/bare, as root; it is removed afterwards.
# MIRROR is where Debian's packages come from.
set -euo pipefail
cd "$(dirname "$0")/.."

fail() {
    printf 'error: %s. Try: %s\n' "$1" "$2" >&2
    exit 1
}

package=$(ls -t dist/pluvia_*.deb 2>/dev/null | head -1) || true
[ -n "$package" ] || fail "there is no package" "make deb"
[ "$(id -u)" = 0 ] || fail "a bare system can only be made by root" "sudo make test-deb"
command -v debootstrap >/dev/null ||
    fail "debootstrap is not installed" "apt-get install debootstrap"

bare=target/package/bare
rm -rf "$bare"
trap 'rm -rf "$bare"' EXIT
mirror=${MIRROR:-http://deb.debian.org/debian}
debootstrap --variant=minbase bookworm "$bare" "$mirror" >"target/package/bare.log" 2>&1 ||
    fail "debootstrap failed, target/package/bare.log says why" "MIRROR=http://... make test-deb"
# The same sources of packages, and ways to them, as here.
cp -r /etc/apt/apt.conf.d/. "$bare/etc/apt/apt.conf.d/"
cp "$package" "$bare/pluvia.deb"

inside() { chroot "$bare" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root TERM=dumb "$@"; }
inside apt-get update -q >>target/package/bare.log 2>&1
inside apt-get install -q -y --no-install-recommends /pluvia.deb >>target/package/bare.log 2>&1 ||
    fail "the package cannot be installed, target/package/bare.log says why" "make deb"
inside pluvia --version
inside pluvia run /usr/share/pluvia/scenarios/quick/pluviation.json --out /first --quiet
[ -s "$bare/first/summary.json" ] || fail "the run left no summary.json" "make test"
for file in usr/share/man/man1/pluvia-run.1.gz usr/share/bash-completion/completions/pluvia; do
    [ -s "$bare/$file" ] || fail "/$file is missing" "scripts/package.sh deb"
done
for file in THIRD-PARTY-NOTICES copyright; do
    grep -q '^ \?rapier3d-f64 .* | Apache-2.0 | [0-9]' "$bare/usr/share/doc/pluvia/$file" ||
        fail "/usr/share/doc/pluvia/$file lacks the notices of linked crates" "scripts/package.sh deb"
done
# Nothing is left when it goes.
inside apt-get purge -q -y pluvia >>target/package/bare.log 2>&1
left=$(find "$bare/usr" -name '*pluvia*' -not -path '*/doc/*' | head -3)
[ -z "$left" ] || fail "removing it leaves $left" "scripts/package.sh deb"
echo "the package installs, runs and goes on a bare Debian 12"
