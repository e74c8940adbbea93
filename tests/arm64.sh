#!/usr/bin/env bash
# The tests of the core, the models and the kernels on 64-bit ARM, under emulation: what is proven on x86-64 must not depend on it.
#
#   tests/arm64.sh FOLDER     sets up a Debian 12 with compiler and emulator in FOLDER (2 GB), builds the tests, and runs them
#
# FOLDER is used again: remove it to begin anew. Written for Debian 12, as root; what it needs and does not find is installed by
# apt. The compiler is Debian's (rustc-web), as the ARM standard library comes with it; sources are those that cargo fetched.
# Exit status: 0 all passed, 1 a test failed, 2 usage, 3 something was not run; tests that are too slow here are named.
set -euo pipefail
cd "$(dirname "$0")/.."
. tests/drivers/setup.sh

# Exhaustive ones, which take hours under emulation, each with the reason that is printed.
slow_tests() {
    cat <<'LIST'
kernel exhaustive::every_source_destination_and_alpha_of_the_common_states
kernel numbers::every_equation_on_numbers_and_their_ties
outmerge identify::
outmerge conform::
outmerge admissible::tests::models::every_model_lies_inside_the_set_it_claims
outmerge scene::history::tests::histories_end_in_the_rendered_bytes
outmerge scene::tests::planned_and_reference_rendering_leave_the_same_bytes_in_every_scene_and_model
LIST
}

target=aarch64-unknown-linux-gnu
features=json,proptest,scene,parallel
[ $# -eq 1 ] || { sed -n '2,/^set/{/^#/s/^# \?//p}' "$0" >&2; exit 2; }
[ "$(id -u)" -eq 0 ] || { echo 'not run: setting up and entering another system needs root' >&2; exit 3; }
mkdir -p "$1/target"
folder=$(cd "$1" && pwd)
root=$folder/root
cargo_home=${CARGO_HOME:-$HOME/.cargo}

step() { printf '\n== %s\n' "$*" >&2; }

step 'A Debian 12 with an ARM compiler and emulator'
install_packages mmdebstrap:mmdebstrap jq:jq unshare:util-linux
if [ ! -x "$root/usr/bin/qemu-aarch64" ]; then
    rm -rf "$root"
    system=rustc-web,cargo-web,gcc,libc6-dev,libstd-rust-web-dev:arm64,gcc-aarch64-linux-gnu,libc6-dev-arm64-cross,libc6:arm64,qemu-user
    mmdebstrap --variant=minbase --mode=root --architectures=amd64,arm64 --include="$system" bookworm "$root" >&2 ||
        { echo "not run: the system could not be set up in $root" >&2; rm -rf "$root"; exit 3; }
fi
cargo fetch --locked --target "$target"

# Runs a command in the other system, with the sources where they are here. The mounts end with the process.
inside() {
    # shellcheck disable=SC2016
    unshare --mount bash -euc '
        root=$1
        mount -t proc proc "$root/proc"
        mount --rbind /dev "$root/dev"
        for shared in "$2" "$3" "$4"; do
            mkdir -p "$root$shared"
            mount --bind "$shared" "$root$shared"
        done
        source=$2 cargo_home=$3 target=$4
        shift 4
        exec chroot "$root" env -i PATH=/usr/bin:/bin HOME=/root CARGO_HOME="$cargo_home" CARGO_TARGET_DIR="$target" \
            CARGO_NET_OFFLINE=true CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_LINKER=aarch64-linux-gnu-gcc \
            sh -c "cd \"\$0\" && exec \"\$@\"" "$source" "$@"' enter "$root" "$PWD" "$cargo_home" "$folder/target" "$@"
}

step 'Building the tests'
tests=$(inside cargo test --locked --no-default-features --features "$features" --target "$target" \
    --lib --test laws --test kernel --test exact --no-run --message-format=json |
    jq -r 'select(.executable != null) | "\(.target.name) \(.executable)"')
[ -n "$tests" ] || { echo 'not run: cargo names no test executable' >&2; exit 3; }

failed=
while read -r name executable; do
    step "$name on $target"
    skip=()
    while read -r of test; do
        [ "$of" = "$name" ] || continue
        echo "not run: $name $test: too slow under emulation" >&2
        skip+=(--skip "$test")
    done < <(slow_tests)
    inside qemu-aarch64 "$executable" "${skip[@]}" </dev/null >&2 || failed+=" $name"
done <<<"$tests"
[ -z "$failed" ] || { echo "failed on $target:$failed" >&2; exit 1; }
step "All passed on $target, under emulation, but for those named as not run"
