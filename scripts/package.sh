#!/usr/bin/env bash
# Packs the release program for people who do not build it.
#
#   scripts/package.sh deb        dist/pluvia_VERSION-1_ARCHITECTURE.deb
#   scripts/package.sh archive    dist/pluvia-VERSION-MACHINE-linux.tar.xz
#   scripts/package.sh checksums  dist/SHA256SUMS of what is there
#   scripts/package.sh install    prints what the archive says of its installation
#
# Both hold the stripped program, the manual pages and completions that it prints itself,
# scenarios, documentation, the licences of Pluvia and the notices of linked crates. Neither holds
# Bullet: the package depends on Debian's, the archive says what to install. PLUVIA is the program,
# target/release/pluvia unless given; MAINTAINER who answers for the package.
set -euo pipefail
cd "$(dirname "$0")/.."

program=${PLUVIA:-target/release/pluvia}
out=target/package # what is packed
made=dist
version=$(sed -n 's/^version = "\(.*\)"$/\1/p' Cargo.toml | head -1)

fail() {
    printf 'error: %s. Try: %s\n' "$1" "$2" >&2
    exit 1
}

[ -x "$program" ] || fail "there is no program $program" "make build"
if [ "$("$program" --version)" != "pluvia $version" ]; then
    fail "$program is $("$program" --version), Cargo.toml has $version" "make build"
fi

# The same bytes from the same commit: the time of files is that of the commit.
SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct 2>/dev/null || date +%s)}
export SOURCE_DATE_EPOCH

# What both hold, as under /usr: PROGRAM MAN COMPLETIONS SHARE DOC
fill() {
    local bin=$1 man=$2 share=$3 doc=$4
    mkdir -p "$bin" "$man" "$share" "$doc"
    install -m 755 "$program" "$bin/pluvia"
    strip "$bin/pluvia"
    "$program" man --out "$man" >/dev/null
    gzip -9n "$man"/*.1
    cp -r scenarios "$share/scenarios"
    cp README.md CHANGELOG.md CITATION.cff "$doc/"
    python3 scripts/notices.py Cargo.toml "$doc/THIRD-PARTY-NOTICES"
    cp -r docs "$doc/docs"
}

completions() { # ROOT
    mkdir -p "$1/bash-completion/completions" "$1/zsh/vendor-completions" \
        "$1/fish/vendor_completions.d"
    "$program" completions bash >"$1/bash-completion/completions/pluvia"
    "$program" completions zsh >"$1/zsh/vendor-completions/_pluvia"
    "$program" completions fish >"$1/fish/vendor_completions.d/pluvia.fish"
}

same_time() { # FOLDER
    find "$1" -exec touch -h --date="@$SOURCE_DATE_EPOCH" {} +
    chmod -R u=rwX,go=rX "$1"
}

deb() {
    for tool in dpkg-deb dpkg-shlibdeps; do
        command -v $tool >/dev/null ||
            fail "$tool is not installed" "apt-get install dpkg-dev"
    done
    local architecture root depends file
    architecture=$(dpkg --print-architecture)
    root=$out/deb
    rm -rf "$root"
    fill "$root/usr/bin" "$root/usr/share/man/man1" "$root/usr/share/pluvia" \
        "$root/usr/share/doc/pluvia"
    completions "$root/usr/share"
    {
        printf 'Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/\n'
        printf 'Upstream-Name: pluvia\n'
        # Not by name alone: small systems, as containers, leave all else out of /usr/share/doc.
        printf 'Comment: The program contains crates and the font DejaVu Sans (crate dejavu), which have\n'
        printf ' licences of their own.\n .\n'
        sed 's/^$/./; s/^/ /' "$root/usr/share/doc/pluvia/THIRD-PARTY-NOTICES"
        printf '\nFiles: *\nCopyright: the Pluvia authors\n'
        printf 'License: Expat or Apache-2.0\n\nLicense: Expat\n'
        sed 's/^$/./; s/^/ /' LICENSE-MIT
        printf '\nLicense: Apache-2.0\n On Debian systems, see /usr/share/common-licenses/Apache-2.0.\n'
    } >"$root/usr/share/doc/pluvia/copyright"
    gzip -9n "$root/usr/share/doc/pluvia/CHANGELOG.md"

    # What the program is linked to, by Debian's own tool; it wants a debian/control.
    mkdir -p "$out/shlibs/debian"
    printf 'Source: pluvia\n\nPackage: pluvia\nArchitecture: any\n' >"$out/shlibs/debian/control"
    depends=$(cd "$out/shlibs" && dpkg-shlibdeps -O -e"$OLDPWD/$root/usr/bin/pluvia") ||
        fail "dpkg-shlibdeps does not know what the program needs" "apt-get install libbullet-dev"
    depends=${depends#shlibs:Depends=}

    mkdir -p "$root/DEBIAN"
    cat >"$root/DEBIAN/control" <<END
Package: pluvia
Version: $version-1
Architecture: $architecture
Maintainer: ${MAINTAINER:-The Pluvia authors <pluvia@example.org>}
Installed-Size: $(du -sk "$root" | cut -f1)
Depends: $depends
Section: science
Priority: optional
Description: granular soil as rigid convex polyhedra
 Pluvia makes grains from a sieve analysis, pours them, shakes them and measures
 what a laboratory measures: standing height, void ratio, settlement, angle of
 repose. The Bullet physics library carries the grains.
 .
 Scenarios are in /usr/share/pluvia/scenarios, documentation in
 /usr/share/doc/pluvia.
END
    same_time "$root"
    file=$made/pluvia_$version-1_$architecture.deb
    dpkg-deb --root-owner-group -Zxz --build "$root" "$file" >/dev/null
    echo "$file, $(du -h "$file" | cut -f1)"
}

# Of the system that the program was built on, and of the Bullet that it is linked to there.
install_text() {
    local system bullet libraries packages=
    system=$(. "${OS_RELEASE:-/etc/os-release}" && echo "${NAME% GNU/Linux}${VERSION_ID:+ $VERSION_ID}")
    bullet=$("$program" info | sed -n 's/^backend *bullet \([^,]*\), \(.*\)$/Bullet \1 in \2/p')
    [ -n "$bullet" ] || fail "$program does not say which Bullet it has" "$program info"
    libraries=$(ldd "$program" | awk '/libBullet|libLinearMath/ { print $3 }')
    if [ -n "$libraries" ] && command -v dpkg-query >/dev/null; then
        # As dpkg knows them: /lib is a link to /usr/lib.
        packages=$(realpath $libraries | xargs dpkg-query -S | cut -d: -f1 | sort -u | paste -sd' ') ||
            fail "dpkg knows no package of $libraries" "apt-get install libbullet-dev"
        packages="apt-get install $packages"
    fi
    cat <<END
Built on $system for $bullet. Install that first:

    ${packages:-as the system names its package}

then run ./pluvia, or copy it to a folder of PATH, man/ to a MANPATH, and completions/ to where
your shell looks for them.
END
}

archive() {
    local name file
    name=pluvia-$version-$(uname -m)-linux
    rm -rf "${out:?}/$name"
    fill "$out/$name" "$out/$name/man" "$out/$name" "$out/$name"
    completions "$out/$name/completions"
    cp LICENSE-MIT LICENSE-APACHE "$out/$name/"
    install_text >"$out/$name/INSTALL"
    same_time "$out/$name"
    file=$made/$name.tar.xz
    tar --sort=name --owner=0 --group=0 --numeric-owner --mtime="@$SOURCE_DATE_EPOCH" \
        -C "$out" -cJf "$file" "$name"
    echo "$file, $(du -h "$file" | cut -f1)"
}

checksums() {
    (cd "$made" && find . -maxdepth 1 -type f \( -name '*.deb' -o -name '*.tar.xz' -o -name '*.whl' \) \
        -printf '%P\n' | sort | xargs -r sha256sum >SHA256SUMS && cat SHA256SUMS)
}

case ${1:-} in
deb | archive | checksums)
    mkdir -p "$out" "$made"
    "$1"
    ;;
install) install_text ;;
*) fail "scripts/package.sh ${1:-} is not known" "scripts/package.sh deb, archive or checksums" ;;
esac
