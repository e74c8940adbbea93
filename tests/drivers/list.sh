# shellcheck shell=bash disable=SC2034,SC2154 # its variables are those of the scripts that use it
# One driver a line: its name, the model it must match, the function of tests/drivers/setup.sh that sets it up, and what
# that is given.
all_drivers() {
    cat <<'LIST'
installed           llvmpipe                  installed_mesa
bookworm-backports  llvmpipe                  debian_mesa bookworm-backports
trixie              llvmpipe                  debian_mesa trixie
forky               llvmpipe                  debian_mesa forky
sid                 llvmpipe                  debian_mesa sid
chromium-109        swiftshader:chromium=110  npm_swiftshader 109
chromium-110        swiftshader:chromium=110  npm_swiftshader 110
chromium-111        swiftshader               npm_swiftshader 111
chromium-119        swiftshader               npm_swiftshader 119
chromium-131        swiftshader               npm_swiftshader 131
chromium-143        swiftshader               npm_swiftshader 143
chromium-153        swiftshader               npm_swiftshader 153
chromium-debian     swiftshader               debian_swiftshader
LIST
}

# The model that a driver of the list must match.
model_of() { all_drivers | awk -v name="$1" '$1 == name {print $2}'; }

# Sets up a driver of the list; $status says how that ended, and logs/NAME.setup.log why.
# Call it alone: in a condition the shell would go on after a step that fails.
set_up() {
    local setup argument
    read -r _ _ setup argument < <(all_drivers | grep "^$1 ")
    set +e
    (set -e; "$setup" "$1" "$argument") >"$folder/logs/$1.setup.log" 2>&1
    status=$?
    set -e
}
