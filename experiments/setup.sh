# shellcheck shell=bash
# shellcheck disable=SC2034,SC2154  # variables are shared with the scripts that source this file
# Package lists and build functions of experiments/run and tests/run. Source this file with bash after setting `top`
# to the root of the source tree.

# Packages to build the program. dpkg-dev unpacks the SUNDIALS source package. Arb is for truth --certified. GSL is a
# reference solver; it is under the GPL, so only the programs of the build tree are linked with it.
build_packages=(cmake ninja-build g++ git ca-certificates dpkg-dev libfmt-dev nlohmann-json3-dev libcli11-dev
    libtinyxml2-dev libeigen3-dev libboost1.74-dev libmpfr-dev libflint-arb-dev libflint-dev libgsl-dev libasmjit-dev
    zlib1g-dev gnuplot-nox)
test_packages=(libgtest-dev librapidcheck-dev pkgconf libbullet-dev libode-dev parallel)
# the Python module, its optional dependencies for figures and tables
python_packages=(python3-dev pybind11-dev python3-numpy python3-matplotlib python3-pandas python3-mpmath)
# to build the pages of src/documentation
documentation_packages=(python3-sphinx python3-sympy python3-myst-parser python3-numpydoc furo libjs-katex doxygen)
python_test_packages=(python3-scipy python3-pytest python3-hypothesis mypy)
# to build and check packages
package_packages=(file lintian python3-pip python3-setuptools python3-wheel)
# engines that `experiments/run engines` compares; npm installs the engines for Node
engine_packages=(pkgconf libbullet-dev libode-dev libmujoco-dev libsimbody-dev libdart-dev nodejs npm)
# browsers in which the report page is tested
browser_packages=(chromium firefox-esr)
# for tests/run --all
check_packages=(libbenchmark-dev clang libclang-rt-14-dev lld clang-format clang-tidy codespell)

die() {
    echo "$(basename "$0"): $*" >&2
    exit 2
}

is_installed() { [[ $(dpkg-query -W -f '${db:Status-Status}' "$1" 2>/dev/null) == installed ]]; }

# install_missing PACKAGE..: installs missing packages without removing others
install_missing() {
    local package missing=()
    if ! command -v dpkg-query >/dev/null; then
        echo "not a Debian system; install these packages (Debian names): $*" >&2
        return
    fi
    for package in "$@"; do
        is_installed "$package" || missing+=("$package")
    done
    ((${#missing[@]})) || return 0
    local as_root=()
    if ((EUID != 0)); then
        command -v sudo >/dev/null || die "installing packages needs root or sudo; install: ${missing[*]}"
        as_root=(sudo)
    fi
    echo "== installing ${missing[*]}" >&2
    # an unreachable source does not stop the script; the installation below fails if a package is missing
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=600 update -qq \
        </dev/null >&2 || true
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=600 install -y -qq \
        --no-remove --no-install-recommends "${missing[@]}" </dev/null >&2
}

# preset NAME [CMAKE OPTION..]: configures a CMake preset. If ccache is installed, files that were compiled before, in
# this or another checkout, are not compiled again.
preset() {
    local name=$1 launchers=() launcher="env;CCACHE_BASEDIR=$top;CCACHE_NOHASHDIR=1"
    launcher+=";CCACHE_SLOPPINESS=time_macros,include_file_mtime,include_file_ctime;ccache"
    shift
    ! command -v ccache >/dev/null ||
        launchers=("-DCMAKE_C_COMPILER_LAUNCHER=$launcher" "-DCMAKE_CXX_COMPILER_LAUNCHER=$launcher")
    (cd "$top" && cmake --preset "$name" "${launchers[@]}" "$@")
}

# configure PRESET [CMAKE OPTION..]: configures, with libsundials-dev if the mirror has no source package of SUNDIALS
configure() {
    local log=$top/build/configure.log
    mkdir -p "$top/build"
    if ! preset "$@" 2>&1 | tee "$log"; then
        grep -q 'SUNDIALS not found: its source package is not available' "$log" || return 1
        install_missing libsundials-dev
        preset "$@"
    fi
}

# build PRESET TARGET [CMAKE OPTION..]: configures a preset and builds a target
build() {
    local preset=$1 target=$2
    shift 2
    configure "$preset" "$@"
    (cd "$top" && cmake --build --preset "$preset" --target "$target")
}

# install_wanted PACKAGE..: installs optional packages one by one; reports and skips those that are not available
install_wanted() {
    local package
    for package in "$@"; do
        # skip if Node is already installed from another source
        [[ $package != nodejs && $package != npm ]] || ! command -v "${package/nodejs/node}" >/dev/null || continue
        (install_missing "$package") || echo "skipped: package $package is not available" >&2
    done
}

# install_node_engines: installs the packages of build/engines/package.json if npm and its registry are available
install_node_engines() {
    local directory=$top/build/engines
    [[ -s $directory/package-lock.json ]] || return 0
    if ! command -v node >/dev/null || ! command -v npm >/dev/null; then
        echo "engines for Node skipped: node or npm is missing" >&2
    elif ! cmp -s "$directory/package-lock.json" "$directory/node_modules/.installed"; then
        if (cd "$directory" && timeout 300 npm ci --no-audit --no-fund --loglevel=error) >&2; then
            cp "$directory/package-lock.json" "$directory/node_modules/.installed"
        else
            echo "engines for Node skipped: npm ci failed" >&2
        fi
    fi
}
