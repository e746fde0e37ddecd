# Configures `cpack`: one Debian package per component, and with CPackSourceConfig.cmake the source package of all files
# that git tracks. README.md describes the commands.
set(CPACK_PACKAGE_NAME polhode)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_VENDOR "polhode developers")
# not a valid address: mail to .invalid is not delivered
set(CPACK_PACKAGE_CONTACT "polhode developers <developers@polhode.invalid>")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_VERBATIM_VARIABLES ON)
# the summary of each package is the first line of its description: no common summary
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")

set(CPACK_GENERATOR DEB)
set(CPACK_COMPONENTS_ALL program development)
if(POLHODE_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
# one package per component
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_THREADS 0)
set(CPACK_PACKAGE_CHECKSUM SHA256)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME polhode)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS gnuplot-nox)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "python3-polhode, libpolhode-dev")
set(CPACK_DEBIAN_PROGRAM_DESCRIPTION "high-accuracy rigid-body integrator and laboratory
polhode simulates rigid bodies and mechanisms with more than a hundred
integrators and reports each one's error, against a reference solution with
proven digits, next to its run time. The methods include closed forms, Taylor
series, extrapolation, Runge-Kutta, geometric and stiff methods, SUNDIALS,
Boost.Odeint and the update loops of game physics.
.
This package contains the program with its manual pages, the catalogue of
scenes and experiments, and examples.")

# the libraries that polhodeConfig.cmake finds and that users of the static libraries link
set(development_depends "libfmt-dev, libtinyxml2-dev, libmpfr-dev, libgmp-dev")
if(POLHODE_ARB)
  string(APPEND development_depends ", libflint-arb-dev, libflint-dev")
endif()
if(POLHODE_ASMJIT)
  string(APPEND development_depends ", libasmjit-dev")
endif()
if(NOT POLHODE_SUNDIALS_LIBRARIES)
  string(APPEND development_depends ", libsundials-dev (>= 6.4)")
endif()
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libpolhode-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "${development_depends}")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS "cmake, polhode")
set(CPACK_DEBIAN_DEVELOPMENT_DESCRIPTION "high-accuracy rigid-body integrator - static library
polhode simulates rigid bodies and mechanisms with more than a hundred
integrators and reports each one's error, against a reference solution with
proven digits, next to its run time.
.
This package contains the static libraries, the C++20 headers, the CMake
package files for find_package, and an example project.")

if(POLHODE_PYTHON)
  # the module supports one minor version of Python
  math(EXPR next_minor "${POLHODE_PYTHON_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-polhode)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
    "python3 (>= 3.${POLHODE_PYTHON_MINOR}~), python3 (<< 3.${next_minor}), python3-numpy")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "python3-matplotlib, python3-pandas, python3-mpmath")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA
    "${CMAKE_CURRENT_LIST_DIR}/python/postinst;${CMAKE_CURRENT_LIST_DIR}/python/prerm")
  set(CPACK_DEBIAN_PYTHON_DESCRIPTION "high-accuracy rigid-body integrator - Python 3 module
polhode simulates rigid bodies and mechanisms with more than a hundred
integrators and reports each one's error, against a reference solution with
proven digits, next to its run time.
.
This package contains the Python module: scenes, solutions as NumPy arrays,
reference solutions, errors, ensembles and experiments. Figures need
Matplotlib, tables need pandas, and certified digits need mpmath.")
endif()

set(CPACK_SOURCE_GENERATOR TGZ)
set(CPACK_SOURCE_PACKAGE_FILE_NAME polhode-${PROJECT_VERSION})
# source.cmake copies the files that git tracks
set(CPACK_SOURCE_INSTALLED_DIRECTORIES "")
set(CPACK_INSTALL_SCRIPTS ${CMAKE_CURRENT_LIST_DIR}/source.cmake)
set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_CURRENT_LIST_DIR}/debian.cmake)
set(CPACK_POLHODE_SOURCE_DIR ${PROJECT_SOURCE_DIR})
set(CPACK_POLHODE_BINARY_DIR ${PROJECT_BINARY_DIR})
include(CPack)
