# Run by CPack while it collects files. For the source package, copies the files that git tracks. Without git, in an
# unpacked source package, copies everything except the build directory.
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
  message(STATUS "not a git checkout: packing the whole tree")
  file(RELATIVE_PATH build ${source} ${CPACK_POLHODE_BINARY_DIR})
  execute_process(COMMAND tar -C ${source} --exclude=./${build} --exclude=./build --exclude=__pycache__ -cf - .
    COMMAND tar -C ${CMAKE_INSTALL_PREFIX} -xf - COMMAND_ERROR_IS_FATAL ANY)
endif()
# includes the built page of reports, for users without Node
if(EXISTS ${source}/build/report/page.html)
  configure_file(${source}/build/report/page.html ${CMAKE_INSTALL_PREFIX}/src/report/page/built.html COPYONLY)
endif()
