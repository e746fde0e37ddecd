# shellcheck shell=bash
# What the scripts here share. To be sourced by bash, after `set -euo pipefail`.

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)

die() {
    echo "$(basename "$0"): $*" >&2
    exit 1
}

# cached BUILD NAME: what the build directory's cache says
cached() { sed -nE "s/^$2:[A-Z]+=(.*)/\1/p" "$1/CMakeCache.txt"; }

# the one version, as CMakeLists.txt states it
version=$(sed -nE 's/^project\(polhode VERSION ([0-9.]+).*/\1/p' "$top/CMakeLists.txt")
[[ -n $version ]] || die "CMakeLists.txt states no version"

# solve_in_python PYTHON DIRECTORY: the module found below DIRECTORY is of this version and solves a scene
solve_in_python() {
    (cd / && "$1" -B - "$2" "$version") <<'END'
import sys

import polhode

directory, version = sys.argv[1:]
assert polhode.__file__.startswith(directory), polhode.__file__
assert polhode.__version__ == version, polhode.__version__
motion = polhode.solve("lagrange_top", "taylor", tolerance=1e-10)
assert motion.status == "ok", motion.status
assert motion.errors().max["attitude"] < 1e-6
assert not [name for name in map(str, polhode.methods()) if "gsl" in name]
END
}

# no_gpl FILE: what it is linked with, directly or not
no_gpl() {
    local libraries
    libraries=$(ldd "$1")
    ! grep -qiE 'not found|libgsl' <<<"$libraries" || die "$1 is linked with"$'\n'"$libraries"
    ! objdump -p "$1" | grep -E 'R(UN)?PATH' || die "$1 looks for libraries in a directory of its own"
}
