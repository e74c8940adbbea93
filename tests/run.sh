#!/usr/bin/env bash
# Runs every check of the crate: formatting, lints, documentation, all tests. Written for Debian 12 with a Rust toolchain;
# elsewhere install Mesa's lavapipe by hand, and set VK_DRIVER_FILES if its ICD file lies in an unusual place.
set -euo pipefail
cd "$(dirname "$0")/.."

step() { printf '\n== %s\n' "$*" >&2; }

# The software Vulkan driver that results are compared with.
find_icd() {
    local file
    for file in "${VK_DRIVER_FILES:-}" /usr/share/vulkan/icd.d/lvp_icd*.json /usr/local/share/vulkan/icd.d/lvp_icd*.json; do
        if [ -f "$file" ]; then
            printf '%s\n' "$file"
            return
        fi
    done
}

step 'Vulkan driver: lavapipe (Mesa)'
icd=$(find_icd)
if [ -z "$icd" ]; then
    root=()
    [ "$(id -u)" -eq 0 ] || root=(sudo)
    "${root[@]}" apt-get update -qq
    "${root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends \
        libvulkan1 mesa-vulkan-drivers
    icd=$(find_icd)
fi
[ -n "$icd" ] || { echo 'no lavapipe: no lvp_icd*.json found, even after installing mesa-vulkan-drivers' >&2; exit 1; }
echo "$icd" >&2
export VK_DRIVER_FILES=$icd
# A cached shader would answer for a driver that has changed.
export MESA_SHADER_CACHE_DISABLE=true
# A missing adapter fails the comparison tests instead of skipping them.
export OUTMERGE_REQUIRE_ADAPTER=llvmpipe

step 'Formatting'
cargo fmt --check

step 'The core alone depends on none of the optional crates'
heavy=$(cargo tree --locked --no-default-features --edges normal --prefix none | grep -E '^(wgpu|image|clap|serde_json) ' || true)
[ -z "$heavy" ] || { printf 'the core must not depend on:\n%s\n' "$heavy" >&2; exit 1; }

for features in --no-default-features '' --all-features; do
    step "Lints: ${features:-default features}"
    # Unquoted on purpose: no word for the default features.
    cargo clippy --locked --all-targets $features -- -D warnings
done

step 'Documentation'
RUSTDOCFLAGS='-D warnings' cargo doc --locked --no-deps --all-features

step 'Tests'
cargo test --locked --all-features

for example in toy_renderer trail ui_texture splats wgpu_check texture_report identify; do
    step "Example: $example"
    cargo run --quiet --locked --all-features --example "$example"
done

step 'Fuzz targets, a fixed number of runs each'
status=0
tests/fuzz.sh || status=$?
case $status in
    0) ;;
    3) fuzzed=', fuzz targets not run (see above)' ;;
    *) exit "$status" ;;
esac

step "All checks passed${fuzzed:-}"
