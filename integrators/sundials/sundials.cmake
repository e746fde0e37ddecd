# SUNDIALS: by default compiled here at -O3 from the distribution's source package, since Debian's binary is compiled
# without optimisation and a timing of it would speak of the package, not of the method.
#
#   POLHODE_SUNDIALS         source   compile it; where there are no sources the packaged library, labelled so
#                            system   take what find_package(SUNDIALS) finds, labelled so
#   POLHODE_SUNDIALS_PREFIX  where it is compiled to; builds that name the same directory compile it once
#
# Sets  POLHODE_SUNDIALS_BUILD        how it was compiled, in words
#       POLHODE_SUNDIALS_UNOPTIMISED  0 or 1
#       POLHODE_SUNDIALS_LIBRARIES    the static libraries, to be installed along; empty for an installed SUNDIALS
# and the global targets SUNDIALS::cvode, SUNDIALS::cvodes, SUNDIALS::arkode, SUNDIALS::ida.
set(POLHODE_SUNDIALS source CACHE STRING "Source of SUNDIALS: source or system")
set_property(CACHE POLHODE_SUNDIALS PROPERTY STRINGS source system)
set(POLHODE_SUNDIALS_PREFIX "${CMAKE_BINARY_DIR}/sundials" CACHE PATH "Build directory of SUNDIALS")
if(NOT POLHODE_SUNDIALS MATCHES "^(source|system)$")
  message(FATAL_ERROR "POLHODE_SUNDIALS is '${POLHODE_SUNDIALS}'; it must be source or system")
endif()

set(sundials_components cvode cvodes arkode ida)
set(sundials_flags "-ffp-contract=off")
set(sundials_optimisation "-O3 -DNDEBUG")

# _polhode_compile_sundials(DIRECTORY KEY RESULT): RESULT is empty once DIRECTORY holds the installation of this KEY,
# else why it does not. The stamp with the key is written last: without it there is nothing to rely on.
function(_polhode_compile_sundials directory key result)
  set(stamp "${directory}/complete")
  set(${result} "" PARENT_SCOPE)
  # one build at a time; the others wait and then find the stamp
  file(MAKE_DIRECTORY "${POLHODE_SUNDIALS_PREFIX}")
  file(LOCK "${POLHODE_SUNDIALS_PREFIX}" DIRECTORY GUARD FUNCTION TIMEOUT 1800 RESULT_VARIABLE locked)
  if(NOT locked EQUAL 0)
    message(FATAL_ERROR "${POLHODE_SUNDIALS_PREFIX} cannot be locked: ${locked}")
  endif()
  if(EXISTS "${stamp}")
    file(READ "${stamp}" found)
    if(found STREQUAL key)
      return()
    endif()
  endif()
  file(REMOVE_RECURSE "${directory}")
  set(work "${POLHODE_SUNDIALS_PREFIX}/work")
  file(REMOVE_RECURSE "${work}")

  message(STATUS "SUNDIALS: fetching the source package")
  execute_process(COMMAND sh "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/sundials_source.sh" "${work}"
    RESULT_VARIABLE failed ERROR_VARIABLE reason OUTPUT_QUIET ERROR_STRIP_TRAILING_WHITESPACE)
  if(failed)
    file(REMOVE_RECURSE "${work}")
    set(${result} "${reason}" PARENT_SCOPE)
    return()
  endif()
  file(READ "${work}/tree/CMakeLists.txt" version)
  string(REGEX REPLACE ".*PACKAGE_VERSION_MAJOR \"([0-9]+).*PACKAGE_VERSION_MINOR \"([0-9]+).*" "\\1.\\2"
    version "${version}")
  if(version VERSION_LESS 6.4 OR version VERSION_GREATER_EQUAL 7)
    file(REMOVE_RECURSE "${work}")
    set(${result} "the source package has version ${version}, not 6.4 or later of series 6" PARENT_SCOPE)
    return()
  endif()

  message(STATUS "SUNDIALS: compiling it at -O3 into ${directory}")
  cmake_host_system_information(RESULT cores QUERY NUMBER_OF_LOGICAL_CORES)
  set(log "${POLHODE_SUNDIALS_PREFIX}/sundials.log")
  execute_process(
    COMMAND ${CMAKE_COMMAND} -S "${work}/tree" -B "${work}/build" -G "${CMAKE_GENERATOR}"
      "-DCMAKE_MAKE_PROGRAM=${CMAKE_MAKE_PROGRAM}" "-DCMAKE_C_COMPILER=${CMAKE_C_COMPILER}"
      -DCMAKE_BUILD_TYPE=Release "-DCMAKE_C_FLAGS=${sundials_flags}"
      "-DCMAKE_C_FLAGS_RELEASE=${sundials_optimisation}" -DCMAKE_POSITION_INDEPENDENT_CODE=ON
      "-DCMAKE_INSTALL_PREFIX=${directory}" -DCMAKE_INSTALL_LIBDIR=lib
      -DBUILD_STATIC_LIBS=ON -DBUILD_SHARED_LIBS=OFF -DBUILD_IDAS=OFF -DBUILD_KINSOL=OFF
      -DEXAMPLES_ENABLE_C=OFF -DEXAMPLES_ENABLE_CXX=OFF -DEXAMPLES_INSTALL=OFF -DBUILD_TESTING=OFF
    RESULT_VARIABLE failed OUTPUT_FILE "${log}" ERROR_FILE "${log}")
  if(NOT failed)
    execute_process(COMMAND ${CMAKE_COMMAND} --build "${work}/build" --config Release --parallel ${cores}
      --target install
      RESULT_VARIABLE failed OUTPUT_FILE "${log}" ERROR_FILE "${log}")
  endif()
  if(failed)
    message(FATAL_ERROR "SUNDIALS does not compile: see ${log}; "
      "-DPOLHODE_SUNDIALS=system uses an installed one")
  endif()
  file(REMOVE_RECURSE "${work}")
  file(WRITE "${stamp}.new" "${key}")
  file(RENAME "${stamp}.new" "${stamp}")
endfunction()

set(POLHODE_SUNDIALS_LIBRARIES "")
set(POLHODE_SUNDIALS_BUILD "")
set(POLHODE_SUNDIALS_UNOPTIMISED 0)
# what an earlier configuration found must not outlive a change of compiler or of POLHODE_SUNDIALS
if(SUNDIALS_DIR MATCHES "^${POLHODE_SUNDIALS_PREFIX}/")
  unset(SUNDIALS_DIR CACHE)
endif()
set(sundials_why_not "")
if(POLHODE_SUNDIALS STREQUAL "source")
  file(SHA256 "${CMAKE_CURRENT_LIST_FILE}" recipe)
  file(SHA256 "${CMAKE_CURRENT_LIST_DIR}/sundials_source.sh" script)
  file(SIZE "${CMAKE_C_COMPILER}" compiler_size)
  set(sundials_key "6.4 ${CMAKE_C_COMPILER_ID} ${CMAKE_C_COMPILER_VERSION} ${CMAKE_C_COMPILER} ${compiler_size}
${sundials_flags} ${sundials_optimisation}
${recipe} ${script}
")
  # builds by different compilers stand side by side
  string(SHA256 sundials_directory "${sundials_key}")
  string(SUBSTRING "${sundials_directory}" 0 12 sundials_directory)
  set(sundials_directory "${POLHODE_SUNDIALS_PREFIX}/${CMAKE_C_COMPILER_ID}-${sundials_directory}")
  _polhode_compile_sundials("${sundials_directory}" "${sundials_key}" sundials_why_not)
endif()

if(POLHODE_SUNDIALS STREQUAL "source" AND sundials_why_not STREQUAL "")
  set(SUNDIALS_DIR "${sundials_directory}/lib/cmake/sundials" CACHE PATH "Where SUNDIALSConfig.cmake is" FORCE)
  find_package(SUNDIALS 6.4 REQUIRED COMPONENTS ${sundials_components})
  set(POLHODE_SUNDIALS_BUILD "built from source at -O3")
else()
  if(sundials_why_not STREQUAL "")
    find_package(SUNDIALS 6.4 REQUIRED COMPONENTS ${sundials_components})
  else()
    string(REPLACE "\n" "; " sundials_why_not "${sundials_why_not}")
    find_package(SUNDIALS 6.4 QUIET COMPONENTS ${sundials_components})
    if(NOT SUNDIALS_FOUND)
      message(FATAL_ERROR "SUNDIALS not found: its source package is not available (${sundials_why_not}), and no "
        "installed SUNDIALS 6.4 was found. Give apt access to a mirror with sources (and install dpkg-dev), or install "
        "libsundials-dev, or set -DPOLHODE_SUNDIALS=system and SUNDIALS_DIR to an installed one.")
    endif()
    message(WARNING "SUNDIALS is not built from source (${sundials_why_not}); using the installed library")
  endif()
endif()

# whatever the kind of library, by the plain name, and visible to the whole project
set(sundials_location "")
foreach(component IN LISTS sundials_components)
  foreach(kind _static _shared "")
    set(target SUNDIALS::${component}${kind})
    if(NOT TARGET ${target})
      continue()
    endif()
    set_target_properties(${target} PROPERTIES IMPORTED_GLOBAL TRUE)
    if(kind STREQUAL "")
      continue()
    endif()
    get_target_property(sundials_location ${target} LOCATION)
    if(kind STREQUAL "_static" AND POLHODE_SUNDIALS STREQUAL "source" AND sundials_why_not STREQUAL "")
      list(APPEND POLHODE_SUNDIALS_LIBRARIES "${sundials_location}")
    endif()
  endforeach()
  if(NOT TARGET SUNDIALS::${component})
    message(FATAL_ERROR "SUNDIALS in ${SUNDIALS_DIR} has no target SUNDIALS::${component}")
  endif()
endforeach()

if(NOT POLHODE_SUNDIALS_BUILD)
  # Debian's package lies in the directory of the architecture, wherever it was unpacked
  if(CMAKE_LIBRARY_ARCHITECTURE AND sundials_location MATCHES "/usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/")
    set(POLHODE_SUNDIALS_BUILD "packaged library, unoptimised")
    set(POLHODE_SUNDIALS_UNOPTIMISED 1)
  else()
    set(POLHODE_SUNDIALS_BUILD "installed, flags unknown")
  endif()
endif()
set(POLHODE_SUNDIALS_BUILD "${SUNDIALS_VERSION}, ${POLHODE_SUNDIALS_BUILD}")
message(STATUS "SUNDIALS ${POLHODE_SUNDIALS_BUILD} (${SUNDIALS_DIR})")
