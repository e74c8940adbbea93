# shellcheck shell=bash disable=SC2034,SC2154 # its variables are those of tests/drivers.sh
# Compares a driver that was set up, and makes its row of the table.

# Builds the command and the tests as this machine does; both run in the other systems too, whose C library is newer.
build() {
    cargo build --release --locked --features gpu >&2
    target=$(cargo metadata --locked --format-version 1 --no-deps | jq -r .target_directory)
    outmerge=$target/release/outmerge
    crosscheck=$(cargo test --locked --all-features --test crosscheck --no-run --message-format=json |
        jq -r 'select(.executable != null and .target.name == "crosscheck").executable')
    [ -x "$crosscheck" ] || { echo 'cargo names no test executable' >&2; exit 2; }
}

# Runs a command with a driver, and nothing else of the environment that could change its results.
with_driver() {
    local root=$1 icd=$2
    shift 2
    set -- env -i PATH=/usr/bin:/bin HOME=/tmp VK_DRIVER_FILES="$icd" MESA_SHADER_CACHE_DISABLE=true \
        OUTMERGE_REQUIRE_ADAPTER=llvmpipe "$@"
    if [ "$root" = / ]; then
        "$@"
    else
        # A mount namespace of its own: the mounts end with the process, also when it is killed, and nobody who removes
        # the folder meanwhile reaches through them. Tests find the source tree where it was when they were compiled.
        # shellcheck disable=SC2016
        unshare --mount bash -euc '
            root=$1 source=$2 target=$3
            shift 3
            mount -t proc proc "$root/proc"
            mount --rbind /dev "$root/dev"
            for shared in "$source" "$target"; do
                mkdir -p "$root$shared"
                mount --bind "$shared" "$root$shared"
            done
            exec chroot "$root" "$@"' enter "$root" "$PWD" "$target" "$@"
    fi
}

# Compares a driver that was set up with a model and adds its row.
compare() {
    local name=$1 model=$2 kind root icd version result states tests='-' started=$SECONDS
    { read -r kind; read -r root; read -r icd; read -r version || true; } <"$folder/logs/$name.driver"
    local log=$folder/logs/$name
    result=$target/drivers-$name.json
    rm -f "$result"
    # `llvmpipe` or `swiftshader` is also part of the adapter's name.
    local status=0
    with_driver "$root" "$icd" "$outmerge" conform --level quick --adapter "${model%%:*}" --model "$model" \
        --json-file "$result" >"$log.conform.log" 2>&1 || status=$?
    case $status in
        0) ;;
        1) differ=yes ;;
        *) not_run "$name" "conform ended with status $status: $(last_line "$log.conform.log")"; return ;;
    esac
    states=$(jq -r '[.units[].models[]] |
        "\([.[] | .states - .states_matched] | add) of \([.[].states] | add)" +
        ([.[].undecided // 0] | add | if . > 0 then ", \(.) texels undecided" else "" end)' "$result")
    [ "$kind" != mesa ] || tests=$(run_crosscheck "$root" "$icd" "$log.crosscheck.log")
    case $tests in
        -* | *' 0 failed') ;;
        *) differ=yes ;;
    esac
    local adapter llvm
    adapter=$(jq -r .adapter "$result")
    llvm=$(grep -oE 'LLVM [0-9.]+' <<<"$adapter" | head -1 | cut -d' ' -f2) || llvm='-'
    [ -n "$version" ] || version=$(grep -oE 'Mesa [^ ]+' <<<"$adapter")
    row "$name" "$version" "$llvm" "$(processor)" "\`$(jq -r '.models | join(", ")' "$result")\`" "$states" "$tests" \
        "$((SECONDS - started))"
}

# Runs the crosscheck tests and prints how many passed and failed.
run_crosscheck() {
    local status=0 counts
    with_driver "$1" "$2" "$crosscheck" >"$3" 2>&1 || status=$?
    # A driver that crashes takes the count of its tests with it.
    counts=$(grep -oE '[0-9]+ passed; [0-9]+ failed' "$3" | tr -d ';') || counts="ended with status $status"
    grep -E '^test .*FAILED$' "$3" >&2 || true
    echo "${counts/passed/passed,}"
}

# This machine's processor, as its vendor counts.
processor() {
    awk -F': ' '/^vendor_id/ {v=$2} /^cpu family/ {f=$2} /^model\t/ {m=$2}
        END {print v " family " f " model " m}' /proc/cpuinfo
}

row() {
    local line
    line="|$(printf ' %s |' "$@")"
    rows+=("$line")
    echo "$line" >&2
}

# The row of a driver that was not run.
not_run() {
    missing=yes
    row "$1" "not run: $2" '' '' '' '' '' ''
}

# The last line of a log with anything on it, fit for a table.
last_line() { grep -v '^[[:space:]]*$' "$1" | tail -1 | tr '|' '/' | cut -c1-200; }
