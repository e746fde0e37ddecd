# shellcheck shell=bash
# shellcheck disable=SC2034,SC2154  # names are shared with the scripts that source this
# What experiments/run and tests/run share: packages and the build. To be sourced by bash, with `top` set to the
# source tree's root.

# what the program is built from; dpkg-dev unpacks the SUNDIALS source package, Arb is for truth --certified,
# GSL is measured beside and goes into the build tree's programs alone: it is under the GPL
build_packages=(cmake ninja-build g++ git ca-certificates dpkg-dev libfmt-dev nlohmann-json3-dev libcli11-dev
    libtinyxml2-dev libeigen3-dev libboost1.74-dev libmpfr-dev libflint-arb-dev libflint-dev libgsl-dev libasmjit-dev
    zlib1g-dev gnuplot-nox)
test_packages=(libgtest-dev librapidcheck-dev pkgconf libbullet-dev libode-dev parallel)
# the Python module, what its pictures and tables are made with, and its tests
python_packages=(python3-dev pybind11-dev python3-numpy python3-matplotlib python3-pandas python3-mpmath)
# the pages of src/documentation
documentation_packages=(python3-sphinx python3-myst-parser python3-numpydoc furo libjs-katex doxygen)
python_test_packages=(python3-scipy python3-pytest python3-hypothesis mypy)
# what makes and reads packages
package_packages=(file lintian python3-pip python3-setuptools python3-wheel)
# the engines that `experiments/run engines` compares; those under Node come by npm
engine_packages=(pkgconf libbullet-dev libode-dev libmujoco-dev libsimbody-dev libdart-dev nodejs npm)
# what the report's page is tested in
browser_packages=(chromium firefox-esr)
# for tests/run --all
check_packages=(libbenchmark-dev clang libclang-rt-14-dev lld clang-format clang-tidy codespell)

die() {
    echo "$(basename "$0"): $*" >&2
    exit 2
}

is_installed() { [[ $(dpkg-query -W -f '${db:Status-Status}' "$1" 2>/dev/null) == installed ]]; }

# install_missing PACKAGE..: those that are missing, without removing any
install_missing() {
    local package missing=()
    if ! command -v dpkg-query >/dev/null; then
        echo "not a Debian system; needed, by Debian's names: $*" >&2
        return
    fi
    for package in "$@"; do
        is_installed "$package" || missing+=("$package")
    done
    ((${#missing[@]})) || return 0
    local as_root=()
    if ((EUID != 0)); then
        command -v sudo >/dev/null || die "neither root nor sudo; please install: ${missing[*]}"
        as_root=(sudo)
    fi
    echo "== installing ${missing[*]}" >&2
    # one unreachable source among many is no reason to stop: the installation decides
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=600 update -qq \
        </dev/null >&2 || true
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=600 install -y -qq \
        --no-remove --no-install-recommends "${missing[@]}" </dev/null >&2
}

# preset NAME [CMAKE OPTION..]: configures it. What was compiled once, here or in another checkout, is not compiled again
# where ccache is installed.
preset() {
    local name=$1 launchers=() launcher="env;CCACHE_BASEDIR=$top;CCACHE_NOHASHDIR=1"
    launcher+=";CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime;ccache"
    shift
    ! command -v ccache >/dev/null ||
        launchers=("-DCMAKE_C_COMPILER_LAUNCHER=$launcher" "-DCMAKE_CXX_COMPILER_LAUNCHER=$launcher")
    (cd "$top" && cmake --preset "$name" "${launchers[@]}" "$@")
}

# configure PRESET [CMAKE OPTION..]: where the mirror has no sources of SUNDIALS, the packaged library stands in
configure() {
    local log=$top/build/configure.log
    mkdir -p "$top/build"
    if ! preset "$@" 2>&1 | tee "$log"; then
        grep -q 'SUNDIALS not found: its source package is not available' "$log" || return 1
        install_missing libsundials-dev
        preset "$@"
    fi
}

# build PRESET TARGET [CMAKE OPTION..]
build() {
    local preset=$1 target=$2
    shift 2
    configure "$preset" "$@"
    (cd "$top" && cmake --build --preset "$preset" --target "$target")
}

# install_wanted PACKAGE..: each by itself; one that cannot be had is named and left out
install_wanted() {
    local package
    for package in "$@"; do
        # whoever has Node from elsewhere has it
        [[ $package != nodejs && $package != npm ]] || ! command -v "${package/nodejs/node}" >/dev/null || continue
        (install_missing "$package") || echo "left out: $package cannot be had" >&2
    done
}

# install_node_engines: what build/engines/package.json names, where npm is there and its registry in reach
install_node_engines() {
    local directory=$top/build/engines
    [[ -s $directory/package-lock.json ]] || return 0
    if ! command -v node >/dev/null || ! command -v npm >/dev/null; then
        echo "the engines under Node are left out: there is no node or no npm" >&2
    elif ! cmp -s "$directory/package-lock.json" "$directory/node_modules/.installed"; then
        if (cd "$directory" && timeout 300 npm ci --no-audit --no-fund --loglevel=error) >&2; then
            cp "$directory/package-lock.json" "$directory/node_modules/.installed"
        else
            echo "the engines under Node are left out: npm cannot install them" >&2
        fi
    fi
}
