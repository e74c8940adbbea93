#!/usr/bin/env bash
# Mutation tests of whole rooms (folders of src): cargo-mutants lists the mutants, all of a room are compiled at once behind
# switches, and each is tried by the tests that reach it (tests/mutations/rooms). Writes OUT/ROOM.tsv, a line a mutant, and prints
# a table; exit status 1 unless nine of ten viable mutants are caught in every room. Takes hours for all rooms.
# usage: tests/mutations/rooms.sh OUT ROOM... [--survivors FILE]
# Needs: cargo install cargo-mutants --version 27.1.0; lavapipe, as tests/run.sh installs it.
set -euo pipefail
[ $# -ge 2 ] || { grep '^# usage' "$0" >&2; exit 2; }
mkdir -p "$1"
out=$(cd "$1" && pwd)
shift
cd "$(dirname "$0")/../.."
. tests/mutations/blocks.sh
copy_tree
cargo build --quiet --release --locked --manifest-path tests/mutations/rooms/Cargo.toml --target-dir "$CARGO_TARGET_DIR/rooms"
export MESA_SHADER_CACHE_DISABLE=true OUTMERGE_REQUIRE_ADAPTER=llvmpipe RUST_BACKTRACE=0
"$CARGO_TARGET_DIR/rooms/release/rooms" "$copy" "$out" "$@"
