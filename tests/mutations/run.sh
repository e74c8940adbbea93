#!/usr/bin/env bash
# Mutation check: applies every single-point mutation of mutations.txt to a copy of the tree, one at a time, and runs the
# fast tests, first the core's unit tests, then the laws. A mutation that no test notices has survived: exit status 1.
# usage: tests/mutations/run.sh [PART-OF-A-NAME]
set -euo pipefail
cd "$(dirname "$0")/../.."
. tests/mutations/blocks.sh
only=${1:-}
copy_tree

unit=(cargo test --locked --quiet --no-default-features --lib)
laws=(cargo test --locked --quiet --no-default-features --features json,proptest,scene --test laws)

# Runs a test command on the copy: 0 passes, 1 a test fails, 2 it does not compile.
try() {
    (cd "$copy" && "${@:1:3}" --no-run "${@:4}") >"$copy/log" 2>&1 || return 2
    (cd "$copy" && timeout 600 "$@") >"$copy/log" 2>&1 || return 1
}

try "${unit[@]}" || { cat "$copy/log"; echo 'the unmutated unit tests fail' >&2; exit 2; }
try "${laws[@]}" || { cat "$copy/log"; echo 'the unmutated laws fail' >&2; exit 2; }

# Whether the tests still pass, for `check`.
probe() {
    local status=0 by='unit tests'
    try "${unit[@]}" || status=$?
    if [ "$status" -eq 0 ]; then
        by='laws'
        try "${laws[@]}" || status=$?
    fi
    shown="by the $by: $(grep -m1 -oE '^test .* FAILED|^    [a-z_:0-9]+$' "$copy/log" | sed 's/^ *//; s/^test //; s/ \.\.\. FAILED//' || true)"
    return "$status"
}

each_block tests/mutations/mutations.txt check
verdict
