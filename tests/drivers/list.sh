# shellcheck shell=bash
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
