#!/usr/bin/env bash
# Looks at every access to memory that the C++ of cpp/ makes.
#
#   scripts/test-sanitizers.sh address   AddressSanitizer with its leak check and
#                                        UndefinedBehaviorSanitizer, on the bridge alone
#   scripts/test-sanitizers.sh thread    ThreadSanitizer, on the bridge alone
#   scripts/test-sanitizers.sh crate     the first on the crate's unit tests of worlds and on
#                                        runs of every kind of stage, the second on unit tests
#                                        of threads
#   scripts/test-sanitizers.sh valgrind  memcheck on the program as it is built
#
# Several of these words may stand together; without one: all of them. Rust and Debian's Bullet are built as ever: what is
# looked at is what the shims do, and every block of memory they are given or
# give back, whoever made it. A finding ends the program, and this script.
set -euo pipefail
# A build that fails within `$(…)` ends it, and with it this script.
shopt -s inherit_errexit
cd "$(dirname "$0")/.."

fail() {
    printf 'error: %s. Try: %s\n' "$1" "$2" >&2
    exit 1
}

# The C++ is the same at every level; Rust is built sooner without any.
export CARGO_PROFILE_DEV_OPT_LEVEL=0
export ASAN_OPTIONS=abort_on_error=0:detect_stack_use_after_return=1:check_initialization_order=1:strict_init_order=1:detect_leaks=1
export LSAN_OPTIONS=report_objects=1
export UBSAN_OPTIONS=print_stacktrace=1:halt_on_error=1
scenarios=$PWD/tests/sanitizers
export TSAN_OPTIONS="halt_on_error=1:second_deadlock_stack=1:exitcode=66:suppressions='$scenarios/tsan.supp'"

folder=$PWD/target/sanitize
mkdir -p "$folder"

# Addresses are not drawn at random: runtimes of this age know a kernel's older
# ranges alone. Where that is not allowed, as in some containers, it is tried so.
fixed=()
setarch -R true 2>/dev/null && fixed=(setarch -R)

# The runtime must come before all other libraries.
with() {
    local runtime=$1
    shift
    "${fixed[@]}" env LD_PRELOAD="$(runtime_of "$runtime")" "$@"
}

runtime_of() {
    case $1 in
        address) echo "$(gcc -print-file-name=libasan.so) $(gcc -print-file-name=libubsan.so)" ;;
        thread) gcc -print-file-name=libtsan.so ;;
    esac
}

# Small faults, each of which must be found: what finds none of them proves nothing.
canaries() {
    local kind=$1 flags=$2 name
    shift 2
    for name in "$@"; do
        g++ -std=c++17 -g -O1 -pthread -fsanitize="$flags" -fno-sanitize-recover=all \
            -DCANARY="$name" "$scenarios/canary.cpp" -o "$folder/canary-$name"
        if "${fixed[@]}" "$folder/canary-$name" >"$folder/canary-$name.txt" 2>&1; then
            if [ "$name" = sound ]; then continue; fi
            fail "$kind finds no fault in canary.cpp, $name" "cat $folder/canary-$name.txt"
        elif [ "$name" = sound ]; then
            fail "$kind finds a fault where there is none" "cat $folder/canary-$name.txt"
        fi
    done
    echo "$kind: $(($# - 1)) faults made on purpose are found, and none where there is none"
}

# Builds the program of the unit tests with the sanitizers asked for, and says
# where it is; calls of each of these must be in it.
build() {
    local said=$CARGO_TARGET_DIR.txt built symbol
    cargo test --locked --no-run --lib 2>&1 | tee "$said" >&2
    built=$(sed -n 's/^ *Executable .*(\(.*\))$/\1/p' "$said" | tail -1)
    case $built in /*) ;; *) built=$PWD/$built ;; esac
    for symbol in "$@"; do
        nm "$built" | grep "$symbol" >/dev/null ||
            fail "the shims are built without $symbol" "rm -r $CARGO_TARGET_DIR"
    done
    echo "$built"
}

# Runs the unit tests that match; a least number ($2) must have been there.
tests() {
    local kind=$1 least=$2 program=$3 passed
    shift 3
    with "$kind" "$program" --test-threads=1 "$@" >"$folder/$kind-tests.txt" 2>&1 ||
        fail "the unit tests found a fault" "less $folder/$kind-tests.txt"
    passed=$(sed -n 's/^test result: ok\. \([0-9]*\) passed.*/\1/p' "$folder/$kind-tests.txt")
    [ "${passed:-0}" -ge "$least" ] ||
        fail "only $passed tests were run, not $least" "less $folder/$kind-tests.txt"
    echo "$kind: $passed tests, nothing found"
}

# Builds the bridge alone with the sanitizers asked for, and says where it is.
bridge() {
    local program=$folder/bridge-${PLUVIA_SANITIZE:-plain} symbol
    cargo build --locked --manifest-path "$scenarios/bridge/Cargo.toml" --target-dir "$folder/bridge" >&2
    cp "$folder/bridge/debug/pluvia" "$program"
    for symbol in "$@"; do
        nm "$program" | grep "$symbol" >/dev/null ||
            fail "the shims are built without $symbol" "rm -r $folder/bridge"
    done
    echo "$program"
}

# Runs the bridge with a sanitizer; what it says of itself are counts.
use() {
    local kind=$1 program=$2
    shift 2
    with "$kind" "$program" "$@" >"$folder/$kind-$1.txt" 2>&1 ||
        fail "the bridge's $1 found a fault" "less $folder/$kind-$1.txt"
    sed "s/^/$kind: /" "$folder/$kind-$1.txt"
}

address() {
    canaries AddressSanitizer address sound heap stack freed leaked
    canaries UndefinedBehaviorSanitizer undefined,float-cast-overflow sound overflow shift index cast
    local program
    export PLUVIA_SANITIZE=address,undefined
    program=$(bridge __asan_report '__ubsan_handle.*_abort')
    use address "$program" all
    use address "$program" leak 100
    echo 'address: nothing found'
}

thread() {
    canaries ThreadSanitizer thread sound race
    local program
    export PLUVIA_SANITIZE=thread
    program=$(bridge __tsan_write)
    use thread "$program" threads
    echo 'thread: nothing found'
}

crate() {
    local program runs=0 run path threads scenario
    export PLUVIA_SANITIZE=address,undefined CARGO_TARGET_DIR=$folder/address
    program=$(build __asan_report '__ubsan_handle.*_abort')
    tests address 100 "$program" world::bullet world::parity_tests
    cargo build --locked
    # Stock contacts have no threads, and neither press a piece nor let one go.
    for run in native:1 native:2 stock:1; do
        path=${run%:*} threads=${run#*:}
        for scenario in stages pile laboratory; do
            [ "$path $scenario" != "stock laboratory" ] || continue
            rm -rf "$folder/run"
            with address "$CARGO_TARGET_DIR/debug/pluvia" run "$scenarios/$scenario.json" \
                --quiet --set "engine.contact_solver=$path" \
                --set "engine.native.threads=$threads" --out "$folder/run" \
                >"$folder/run.txt" 2>&1 ||
                fail "a run of $scenario.json on $path found a fault" "less $folder/run.txt"
            runs=$((runs + 1))
        done
    done
    echo "crate, address: $runs runs, nothing found"
    export PLUVIA_SANITIZE=thread CARGO_TARGET_DIR=$folder/thread
    program=$(build __tsan_write)
    tests thread 3 "$program" world::bullet::native_tests::threads \
        world::parity_tests::the_same_input world::bullet::shim_tests::what_fails_in_a_thread
}

# Runs a program under memcheck, and ends with 99 where that finds a fault.
under_memcheck() {
    valgrind --quiet --error-exitcode=99 --leak-check=full \
        --show-leak-kinds=definite,indirect \
        --errors-for-leak-kinds=definite,indirect \
        --suppressions="$scenarios/valgrind.supp" \
        --log-file="$folder/valgrind.txt" "$@" </dev/null >/dev/null
}

memcheck() {
    command -v valgrind >/dev/null || fail "valgrind was not found" "sudo apt-get install valgrind"
    unset PLUVIA_SANITIZE CARGO_TARGET_DIR CARGO_PROFILE_DEV_OPT_LEVEL
    local name expected code
    for name in sound heap freed; do
        g++ -std=c++17 -g -O1 -pthread -DCANARY="$name" "$scenarios/canary.cpp" -o "$folder/canary-$name"
        expected=99 code=0
        [ "$name" != sound ] || expected=0
        under_memcheck "$folder/canary-$name" || code=$?
        [ "$code" = "$expected" ] ||
            fail "memcheck ends canary.cpp, $name, with $code, not $expected" "cat $folder/valgrind.txt"
    done
    echo 'valgrind: 2 faults made on purpose are found, and none where there is none'
    cargo build --locked
    local plan=$folder/plan scenario solvers levels level count task stages=0
    for scenario in stages pile laboratory; do
        # Stock contacts neither press a piece nor let one go.
        solvers=native,stock
        [ "$scenario" != laboratory ] || solvers=native
        rm -rf "$plan"
        # Stage by stage, without figures: valgrind is slow.
        target/debug/pluvia sweep "$scenarios/$scenario.json" --plan-only --quiet \
            --over "engine.contact_solver=$solvers" --out "$plan" >/dev/null
        levels=$(target/debug/pluvia stage "$plan" --list |
            sed -n 's/^level \([0-9]*\): \([0-9]*\) stage.*/\1 \2/p')
        [ -n "$levels" ] || fail "the plan of $scenario.json has no stages" "target/debug/pluvia stage $plan --list"
        while read -r level count; do
            for ((task = 0; task < count; ++task)); do
                under_memcheck target/debug/pluvia stage "$plan" --level "$level" --task "$task" --quiet ||
                    fail "valgrind found a fault in level $level of $scenario.json" \
                        "less $folder/valgrind.txt"
                stages=$((stages + 1))
            done
        done <<<"$levels"
    done
    echo "valgrind: $stages stages, nothing found"
}

[ $# -gt 0 ] || set -- address thread crate valgrind
for part in "$@"; do
    case $part in
        address | thread | crate) "$part" ;;
        valgrind) memcheck ;;
        *) fail "there is no part $part" "scripts/test-sanitizers.sh address thread" ;;
    esac
done
