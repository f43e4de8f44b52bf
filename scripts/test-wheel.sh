#!/usr/bin/env bash
# Installs the wheel of `make wheel` on a bare Debian 12, where there is no Bullet, and runs it there.
#
# Makes the bare system with debootstrap in target/wheel/bare, as root; it is removed afterwards.
# MIRROR is where Debian's packages come from. What the wheel depends on is fetched here.
set -euo pipefail
cd "$(dirname "$0")/.."

fail() {
    printf 'error: %s. Try: %s\n' "$1" "$2" >&2
    exit 1
}

wheel=$(ls dist/pluvia-*.whl 2>/dev/null | head -1) || true
[ -n "$wheel" ] || fail "there is no wheel in dist/" "make wheel"
[ "$(id -u)" = 0 ] || fail "a bare system can only be made by root" "sudo make test-wheel"
command -v debootstrap >/dev/null ||
    fail "debootstrap is not installed" "apt-get install debootstrap"

bare=target/wheel/bare log=target/wheel/bare.log
rm -rf "$bare" target/wheel/house
trap 'rm -rf "$bare"' EXIT
# Debian 12 has Python 3.11.
target/wheel/venv/bin/pip download --quiet --only-binary :all: --python-version 3.11 \
    --dest target/wheel/house "$wheel"
mirror=${MIRROR:-http://deb.debian.org/debian}
debootstrap --variant=minbase --include=python3,python3-venv bookworm "$bare" "$mirror" >"$log" 2>&1 ||
    fail "debootstrap failed, $log says why" "MIRROR=http://... make test-wheel"
cp -r target/wheel/house "$bare/house"

inside() { chroot "$bare" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root TERM=dumb "$@"; }
[ -z "$(find "$bare/usr" -name 'libBullet*')" ] || fail "the bare system has Bullet" "rm -rf $bare"
inside python3 -m venv /venv
inside /venv/bin/pip install --quiet --no-index --find-links /house pluvia
inside /venv/bin/python - <<'PYTHON'
from importlib.metadata import files

import pluvia

notices = [file for file in files("pluvia") or [] if file.name == "THIRD-PARTY-NOTICES"]
assert len(notices) == 1 and ".dist-info" in str(notices[0]), f"one file of notices in dist-info: {notices}"
for linked in ("pyo3", "rapier3d-f64"):
    assert f"\n{linked} " in notices[0].read_text(), f"{notices[0]} lacks {linked}"
run = pluvia.run(pluvia.example("quick/pluviation"), "/first", changes={"grains.total_mass_g": 300})
assert run["grains.count"] > 100, run
assert run["void_ratio"] > 0.3, run
assert len(run.contacts) > 0
print(f"pluvia {pluvia.__version__}: {run}, void ratio {run['void_ratio']:.3f}")
PYTHON
echo "the wheel installs and runs on a bare Debian 12 without Bullet"
