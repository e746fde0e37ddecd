# shellcheck shell=bash
# Functions of the scripts in this directory. To be sourced by bash after `set -euo pipefail`.

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)

die() {
    echo "$(basename "$0"): $*" >&2
    exit 1
}

# cached BUILD NAME: prints a variable of the build directory's cache
cached() { sed -nE "s/^$2:[A-Z]+=(.*)/\1/p" "$1/CMakeCache.txt"; }

# the version, from CMakeLists.txt
version=$(sed -nE 's/^project\(polhode VERSION ([0-9.]+).*/\1/p' "$top/CMakeLists.txt")
[[ -n $version ]] || die "CMakeLists.txt: no version found"

# solve_in_python PYTHON DIRECTORY: checks that the module is found in DIRECTORY, has this version and solves a scene
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

# no_gpl FILE: fails if the file links GSL, directly or indirectly, or has a run path
no_gpl() {
    local libraries
    libraries=$(ldd "$1")
    ! grep -qiE 'not found|libgsl' <<<"$libraries" || die "$1 links GSL, or a library is missing:"$'\n'"$libraries"
    ! objdump -p "$1" | grep -E 'R(UN)?PATH' || die "$1 has a run path (RPATH or RUNPATH)"
}
