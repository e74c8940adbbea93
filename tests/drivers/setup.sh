# shellcheck shell=bash disable=SC2154 # its variables are those of tests/drivers.sh
# Sets up drivers in $folder/NAME, each by a function that is called with the name. What is there already is kept: a
# folder gets its name only when it is complete. On failure the last line of the output is the reason.

# Installs what is missing of COMMAND:PACKAGE pairs.
install_packages() {
    local pair packages=()
    for pair in "$@"; do
        command -v "${pair%%:*}" >/dev/null || packages+=("${pair#*:}")
    done
    [ ${#packages[@]} -gt 0 ] || return 0
    echo "installing ${packages[*]}" >&2
    apt-get update -qq
    DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${packages[@]}"
}

# The machine's own Mesa, as tests/run.sh uses it.
installed_mesa() {
    local icd files=(/usr/share/vulkan/icd.d/lvp_icd*.json)
    icd=${VK_DRIVER_FILES:-${files[0]}}
    [ -f "$icd" ] || { echo 'no lavapipe on this machine: install mesa-vulkan-drivers'; return 1; }
    mkdir -p "$folder/$1"
    describe "$1" mesa / "$icd" ''
}

# Mesa of another suite of Debian: a small system of that suite in a folder.
debian_mesa() {
    local name=$1 suite=$2 root=$folder/$1
    if ! has_mesa "$root"; then
        install_packages mmdebstrap:mmdebstrap
        rm -rf --one-file-system "$root" "$root.part"
        # The mirror's index may be older than its date of expiry allows, where the mirror is a frozen one.
        bootstrap "$suite" "$root.part" || retry_expired "$suite" "$root.part" ||
            { grep -m1 '^E: ' "$root.part.log" || echo "mmdebstrap failed, see $root.part.log"; return 1; }
        has_mesa "$root.part" || { echo "mesa-vulkan-drivers of $suite has no lavapipe"; return 1; }
        mv "$root.part" "$root"
    fi
    local files=("$root"/usr/share/vulkan/icd.d/lvp_icd*.json)
    describe "$name" mesa "$root" "${files[0]#"$root"}" ''
}

has_mesa() { compgen -G "$1/usr/share/vulkan/icd.d/lvp_icd*.json" >/dev/null; }

bootstrap() {
    local suite=$1 root=$2
    shift 2
    local options=(--variant=minbase --mode=root --include=mesa-vulkan-drivers --include=libvulkan1 "$@")
    case $suite in
        *-backports)
            # Backports are not a whole suite: its packages come first, the others from the suite below.
            local mirror
            mirror=$(mirror_of "${suite%-backports}")
            [ -n "$mirror" ] || { echo "apt knows no mirror of ${suite%-backports}"; return 1; }
            mmdebstrap "${options[@]}" --aptopt="APT::Default-Release \"$suite\"" "${suite%-backports}" "$root" \
                "deb $mirror ${suite%-backports} main" "deb $mirror $suite main"
            ;;
        *) mmdebstrap "${options[@]}" "$suite" "$root" ;;
    esac 2>&1 | tee "$root.log"
    return "${PIPESTATUS[0]}"
}

# Again without a look at the date, if that was what failed.
retry_expired() {
    grep -qE 'is expired|not valid' "$2.log" || return 1
    echo "the index of $1 is out of date; taken all the same"
    rm -rf --one-file-system "$2"
    bootstrap "$1" "$2" --aptopt='Acquire::Check-Valid-Until "false"'
}

# Where apt has a suite from.
mirror_of() {
    # shellcheck disable=SC2016
    apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' "Codename: $1" | head -1
}

# SwiftShader of a version of Chromium, from the npm package of Chromium for servers.
npm_swiftshader() {
    local name=$1 version=$2 root=$folder/$1
    if [ ! -f "$root/libvk_swiftshader.so" ]; then
        install_packages npm:npm brotli:brotli
        rm -rf "$root" "$root.part"
        mkdir "$root.part"
        (cd "$root.part" && npm pack "@sparticuz/chromium@$version" && tar -xzf ./*.tgz) ||
            { echo "npm has no package @sparticuz/chromium@$version"; return 1; }
        brotli -d -c "$root.part/package/bin/swiftshader.tar.br" | tar -x -C "$root.part"
        sed -n 's/^ *"version": "\(.*\)".*/\1/p' "$root.part/package/package.json" >"$root.part/package-version"
        keep_library "$root.part"
        mv "$root.part" "$root"
    fi
    describe_swiftshader "$name" "Chromium $version (npm $(cat "$root/package-version"))"
}

# SwiftShader of this Debian's Chromium.
debian_swiftshader() {
    local name=$1 root=$folder/$1
    if [ ! -f "$root/libvk_swiftshader.so" ]; then
        rm -rf "$root" "$root.part"
        mkdir "$root.part"
        apt-get update -qq
        (cd "$root.part" && apt-get download chromium-common && dpkg -x chromium-common_*.deb .)
        dpkg-deb -f "$root.part"/chromium-common_*.deb Version >"$root.part/package-version"
        keep_library "$root.part"
        mv "$root.part" "$root"
    fi
    local version
    version=$(cat "$root/package-version")
    describe_swiftshader "$name" "Chromium ${version%%.*} (Debian $version)"
}

# Keeps the library of what was unpacked, and throws away the rest of the browser.
keep_library() {
    local found
    found=$(find "$1" -name libvk_swiftshader.so -print -quit)
    [ -n "$found" ] || { echo 'the package has no libvk_swiftshader.so'; return 1; }
    [ "$found" = "$1/libvk_swiftshader.so" ] || mv "$found" "$1/"
    find "$1" -mindepth 1 ! -name libvk_swiftshader.so ! -name package-version -delete
}

describe_swiftshader() {
    local root=$folder/$1
    cat >"$root/icd.json" <<JSON
{"file_format_version": "1.0.0", "ICD": {"library_path": "$root/libvk_swiftshader.so", "api_version": "1.1.0"}}
JSON
    # It reports no version, so that the library's digest tells the builds apart.
    describe "$1" swiftshader / "$root/icd.json" "$2, SHA-256 $(sha256sum "$root/libvk_swiftshader.so" | cut -c1-12)..."
}

# Writes down for `compare`: kind, the system's root, the ICD file in it, and the version if the driver does not tell.
describe() {
    printf '%s\n' "$2" "$3" "$4" "$5" >"$folder/logs/$1.driver"
}
