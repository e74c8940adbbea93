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
    model=$(all_drivers | awk -v name="$driver" '$1 == name {print $2}')
    { read -r kind; read -r root; read -r icd; } <"$folder/logs/$driver.driver"
    [ -n "$kind" ] || return 5
    with_driver "$root" "$icd" "$target/debug/outmerge" conform --level quick --adapter "${model%%:*}" --model "$model" \
        --only "$units" >"$copy/log" 2>&1
}

caught=0 survivors=() broken=()
declare -A asked

# The unmutated model must match, or a mutation proves nothing.
control() {
    local driver units status=0
    read -r driver units <<<"$5"
    case $1 in *"$only"*) ;; *) return 0 ;; esac
    [ -z "${asked[$5]:-}" ] || return 0
    asked[$5]=yes
    read -r _ _ setup argument < <(all_drivers | grep "^$driver ")
    (set -e; "$setup" "$driver" "$argument") >"$folder/logs/$driver.setup.log" 2>&1 ||
        { echo "not run: $driver: $(last_line "$folder/logs/$driver.setup.log")" >&2; exit 3; }
    ask "$driver" "$units" || status=$?
    [ "$status" -eq 0 ] || { tail -5 "$copy/log"; echo "the unmutated model fails $units on $driver" >&2; exit 2; }
}

check() {
    local name=$1 file=$2 find=$3 replace=$4 driver units status=0
    read -r driver units <<<"$5"
    case $name in *"$only"*) ;; *) return 0 ;; esac
    mutate "$file" "$find" "$replace" || { broken+=("$name: its text is not in $file any more"); return 0; }
    ask "$driver" "$units" || status=$?
    restore "$file"
    case $status in
        0) survivors+=("$name"); echo "SURVIVED  $name ($units on $driver)" ;;
        1) caught=$((caught + 1)); echo "caught    $name ($units on $driver: $(grep -m1 -oE '[0-9]+ of [0-9]+ states differ.*' "$copy/log" || true))" ;;
        *) broken+=("$name: status $status: $(grep -m1 '^error' "$copy/log" || tail -1 "$copy/log")") ;;
    esac
}

each_block tests/mutations/drivers.txt control
each_block tests/mutations/drivers.txt check
verdict
