# CPack runs this script while it stages files. For the source package it copies the files that git tracks, as they
# are in the working tree. Without git, in a tree unpacked from a source package, it copies all but the build
# directory.
if(NOT CPACK_SOURCE_PACKAGE_FILE_NAME STREQUAL CPACK_PACKAGE_FILE_NAME)
  return()
endif()
set(source ${CPACK_POLHODE_SOURCE_DIR})
file(MAKE_DIRECTORY ${CMAKE_INSTALL_PREFIX})
set(no_git TRUE)
if(EXISTS ${source}/.git)
  execute_process(COMMAND git -C ${source} rev-parse --git-dir RESULT_VARIABLE no_git OUTPUT_QUIET ERROR_QUIET)
endif()
if(no_git EQUAL 0)
  execute_process(COMMAND git -C ${source} ls-files -z
    COMMAND tar -C ${source} --null -T - -cf -
    COMMAND tar -C ${CMAKE_INSTALL_PREFIX} -xf - COMMAND_ERROR_IS_FATAL ANY)
else()
  message(STATUS "no git: packing the whole tree except the build directory")
  file(RELATIVE_PATH build ${source} ${CPACK_POLHODE_BINARY_DIR})
  execute_process(COMMAND tar -C ${source} --exclude=./${build} --exclude=./build --exclude=__pycache__ -cf - .
    COMMAND tar -C ${CMAKE_INSTALL_PREFIX} -xf - COMMAND_ERROR_IS_FATAL ANY)
endif()
# include the built report page for systems without Node
if(EXISTS ${source}/build/report/page.html)
  configure_file(${source}/build/report/page.html ${CMAKE_INSTALL_PREFIX}/src/report/page/built.html COPYONLY)
endif()
