#!/usr/bin/env bash
# Runs every fuzz target for a fixed number of runs, from the committed seeds; needs nightly Rust and cargo-fuzz.
# usage: tests/fuzz.sh [-t SECONDS] [TARGET...]   -t: by time instead, keeping what was learnt in fuzz/corpus.
set -euo pipefail
cd "$(dirname "$0")/.."

limit=()
if [ "${1:-}" = -t ]; then
    limit=(-max_total_time="$2")
    shift 2
fi
runs() {
    case $1 in
        shaderlab | webgpu_json | vectors | raster) echo 20000 ;;
        merge | plan | texture) echo 2000 ;;
        kernel) echo 5000 ;;
        scene) echo 5000 ;;
        *) echo "no fuzz target \`$1\`" >&2; exit 2 ;;
    esac
}

if ! cargo +nightly fuzz --version >/dev/null 2>&1; then
    echo 'not run: fuzzing needs a nightly toolchain and cargo-fuzz (cargo install cargo-fuzz)' >&2
    exit 3
fi
targets=("$@")
[ ${#targets[@]} -gt 0 ] || targets=(shaderlab webgpu_json vectors raster scene texture merge plan kernel)
cargo +nightly fuzz build
for target in "${targets[@]}"; do
    # The same bytes mean the same case to both.
    seeds=fuzz/seeds/${target/#plan/merge}
    folders=("$seeds")
    [ "$target" != scene ] || folders+=(src/scene/bundled)
    options=(-rss_limit_mb=4096 -timeout=60 -print_final_stats=1)
    [ ! -f "fuzz/dictionaries/$target.dict" ] || options+=("-dict=fuzz/dictionaries/$target.dict")
    if [ ${#limit[@]} -gt 0 ]; then
        kept=fuzz/corpus/$target
        options+=("${limit[@]}")
    else
        kept=$(mktemp -d)
        options+=(-runs="$(runs "$target")" -seed=1)
    fi
    mkdir -p "$kept"
    printf '\n== fuzz %s: %s\n' "$target" "${options[*]}" >&2
    cargo +nightly fuzz run "$target" "$kept" "${folders[@]}" -- "${options[@]}"
done
