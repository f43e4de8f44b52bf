# shellcheck shell=bash
# For other scripts, which read it with `.`: Python packages of stated versions.

# Has a Python environment hold what is asked for, in these versions; makes it where there is none with pip.
# Says what it held instead. PIP_ONLY_BINARY and the like tell pip more.
pinned() { # ENVIRONMENT REQUIREMENT...
    local environment=$1 requirement name found held=()
    shift
    local pip=("$environment/bin/python" -m pip --disable-pip-version-check)
    # One whose making was interrupted, or whose Python is another by now, has no pip.
    "${pip[@]}" --version >/dev/null 2>&1 || python3 -m venv --clear "$environment" || return
    # Without the network: only what is there may do.
    if "${pip[@]}" install --quiet --no-index "$@" >/dev/null 2>&1; then
        return 0
    fi
    for requirement in "$@"; do
        name=${requirement%%[=<>]*}
        found=$("${pip[@]}" show "$name" 2>/dev/null | sed -n 's/^Version: //p') || true
        held+=("${found:-no} $name")
    done
    echo "$environment has $(printf '%s, ' "${held[@]}" | sed 's/, $//'): installing $*" >&2
    "${pip[@]}" install --quiet "$@"
}
