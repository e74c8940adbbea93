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

caught=0 survivors=() broken=()
# One mutation: changes the file in the copy, tests, and puts the file back.
check() {
    local name=$1 file=$2 find=$3 replace=$4 by='unit tests' status=0
    case $name in *"$only"*) ;; *) return 0 ;; esac
    mutate "$file" "$find" "$replace" || { broken+=("$name: its text is not in $file any more"); return 0; }
    try "${unit[@]}" || status=$?
    if [ "$status" -eq 0 ]; then
        by='laws'
        try "${laws[@]}" || status=$?
    fi
    restore "$file"
    case $status in
        0) survivors+=("$name"); echo "SURVIVED  $name" ;;
        1) caught=$((caught + 1)); echo "caught    $name (by the $by: $(grep -m1 -oE '^test .* FAILED|^    [a-z_:0-9]+$' "$copy/log" | sed 's/^ *//; s/^test //; s/ \.\.\. FAILED//' || true))" ;;
        *) broken+=("$name: does not compile: $(grep -m1 '^error' "$copy/log" || true)") ;;
    esac
}

each_block tests/mutations/mutations.txt check
verdict
