#!/usr/bin/env bash
# The drivers of other distributions and browsers, each compared with its model: the quick level of `conform`, and for each
# Mesa the tests of tests/crosscheck. Prints one table in Markdown, for docs/drivers/drivers.md; all else goes to stderr.
#
#   tests/drivers.sh FOLDER [NAME...]   sets up the named drivers, or all, in FOLDER, and compares them
#   tests/drivers.sh --list             the names
#
# FOLDER keeps the drivers (about 4 GB for all) and the logs, and what is in it is used again: remove FOLDER/NAME to fetch
# that driver anew. Written for Debian 12, as root; packages that it needs and does not find are installed by apt.
# Exit status: 0 all as their models say, 1 a difference or a failed test, 2 usage, 3 a driver was not run.
set -euo pipefail
cd "$(dirname "$0")/.."
. tests/drivers/list.sh
. tests/drivers/setup.sh
. tests/drivers/compare.sh

usage() {
    sed -n '2,/^set/{/^#/s/^# \?//p}' "$0" >&2
    exit 2
}

step() { printf '\n== %s\n' "$*" >&2; }

case ${1:-} in
    --list) all_drivers; exit ;;
    '' | -*) usage ;;
esac
mkdir -p "$1/logs"
folder=$(cd "$1" && pwd)
shift
names=("$@")
[ ${#names[@]} -gt 0 ] || mapfile -t names < <(all_drivers | cut -d' ' -f1)
for name in "${names[@]}"; do
    all_drivers | grep -q "^$name " || { echo "no driver \`$name\`; there are:" >&2; all_drivers >&2; exit 2; }
done
[ "$(id -u)" -eq 0 ] || { echo 'not run: setting up and entering other systems needs root' >&2; exit 3; }

step 'Building the command and the tests'
install_packages jq:jq unshare:util-linux
build

rows=() differ='' missing=''
for name in "${names[@]}"; do
    step "$name"
    model=$(model_of "$name")
    set_up "$name"
    if [ "$status" -eq 0 ]; then
        compare "$name" "$model"
    else
        not_run "$name" "$(last_line "$folder/logs/$name.setup.log")"
    fi
done

cat <<'TABLE'
# Drivers and their models

Made by `tests/drivers.sh`: the quick level of `conform` against the model of each driver, and for each Mesa the tests of
tests/crosscheck. States that differ are those with a texel that the model does not allow.

| driver | version | LLVM | processor | model | states that differ | crosscheck | seconds |
|---|---|---|---|---|---|---|---|
TABLE
printf '%s\n' "${rows[@]}"
[ -z "$differ" ] || exit 1
[ -z "$missing" ] || exit 3
