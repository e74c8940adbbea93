#!/usr/bin/env bash
# Mutation check of the quick level: one wrong digit in a rule of a driver's model must fail `outmerge conform` on that driver.
# Applies every mutation of drivers.txt to a copy of the tree, one at a time, builds the command, and runs the units of the quick
# level that are named there, on the driver that is named there. Units that still match: it has survived, exit status 1.
# usage: tests/mutations/drivers.sh FOLDER [PART-OF-A-NAME]; drivers are set up in FOLDER as by tests/drivers.sh, as root
set -euo pipefail
cd "$(dirname "$0")/../.."
. tests/drivers/list.sh
. tests/drivers/setup.sh
. tests/drivers/compare.sh
. tests/mutations/blocks.sh
[ $# -ge 1 ] || { sed -n '2,5s/^# //p' "$0" >&2; exit 2; }
[ "$(id -u)" -eq 0 ] || { echo 'not run: setting up and entering other systems needs root' >&2; exit 3; }
mkdir -p "$1/logs"
folder=$(cd "$1" && pwd)
only=${2:-}
copy_tree
target=$CARGO_TARGET_DIR

# Builds the command of the copy and asks a driver about units: the status of conform; 5 where it does not compile.
ask() {
    local driver=$1 units=$2 model kind root icd
    (cd "$copy" && cargo build --locked --features gpu) >"$copy/log" 2>&1 || return 5
    model=$(model_of "$driver")
    { read -r kind; read -r root; read -r icd; } <"$folder/logs/$driver.driver"
    [ -n "$kind" ] || return 5
    with_driver "$root" "$icd" "$target/debug/outmerge" conform --level quick --adapter "${model%%:*}" --model "$model" \
        --only "$units" >"$copy/log" 2>&1
}

declare -A asked

# The unmutated model must match, or a mutation proves nothing.
control() {
    local driver units status
    read -r driver units <<<"$5"
    case $1 in *"$only"*) ;; *) return 0 ;; esac
    [ -z "${asked[$5]:-}" ] || return 0
    asked[$5]=yes
    set_up "$driver"
    [ "$status" -eq 0 ] || { echo "not run: $driver: $(last_line "$folder/logs/$driver.setup.log")" >&2; exit 3; }
    ask "$driver" "$units" || status=$?
    [ "$status" -eq 0 ] || { tail -5 "$copy/log"; echo "the unmutated model fails $units on $driver" >&2; exit 2; }
}

# Whether the units of a mutation still match on its driver, for `check`.
probe() {
    local driver units status=0
    read -r driver units <<<"$1"
    ask "$driver" "$units" || status=$?
    shown="$units on $driver: $(grep -m1 -oE '[0-9]+ of [0-9]+ states, [0-9]+ of [0-9]+ texels differ' "$copy/log" || true)"
    return "$status"
}

each_block tests/mutations/drivers.txt control
each_block tests/mutations/drivers.txt check
verdict
