# Copies the public headers to OUTPUT/polhode: polhode.h, laboratory.h and all headers that they include, directly or
# indirectly. In the source tree, includes are relative to src/ or to the root. Users have one include directory and
# write <polhode/..>, so the includes are rewritten in this form.
#
#   cmake -DSOURCE=top -DOUTPUT=directory -P public_headers.cmake
cmake_minimum_required(VERSION 3.22)

set(pending polhode.h laboratory.h)
set(visited "")
while(pending)
  list(POP_FRONT pending header)
  list(APPEND visited ${header})
  set(path ${SOURCE}/src/${header})
  if(NOT EXISTS ${path})
    set(path ${SOURCE}/${header})
  endif()
  file(READ ${path} text)
  string(REGEX MATCHALL "#include \"[^\"]+\"" includes "${text}")
  foreach(include IN LISTS includes)
    string(REGEX REPLACE "#include \"([^\"]+)\"" "\\1" include ${include})
    if(NOT include IN_LIST visited AND NOT include IN_LIST pending)
      list(APPEND pending ${include})
    endif()
  endforeach()
  string(REGEX REPLACE "#include \"([^\"]+)\"" "#include <polhode/\\1>" text "${text}")
  set(old "")
  if(EXISTS ${OUTPUT}/polhode/${header})
    file(READ ${OUTPUT}/polhode/${header} old)
  endif()
  # unchanged headers are not written, so that nothing is compiled again
  if(NOT old STREQUAL text)
    file(WRITE ${OUTPUT}/polhode/${header} "${text}")
  endif()
  # for the manifest of an installation
  list(APPEND CMAKE_INSTALL_MANIFEST_FILES ${CMAKE_INSTALL_PREFIX}/${INCLUDEDIR}/polhode/${header})
endwhile()
