# Installs the tree built in BUILD, moves what was installed elsewhere, builds the consumer against it and runs it.
# Called by ctest with BUILD, SOURCE, WORK, COMPILER, FLAGS, GENERATOR.
function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE result)
  if(NOT result EQUAL 0)
    list(JOIN ARGV " " command)
    message(FATAL_ERROR "${command}: ${result}")
  endif()
endfunction()

file(REMOVE_RECURSE ${WORK})
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/installed)
file(RENAME ${WORK}/installed ${WORK}/moved)
run(${CMAKE_COMMAND} -S ${SOURCE} -B ${WORK}/build -G ${GENERATOR} -DCMAKE_BUILD_TYPE=Release
  -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_CXX_FLAGS=${FLAGS} -DCMAKE_PREFIX_PATH=${WORK}/moved
  -DCMAKE_FIND_PACKAGE_NO_PACKAGE_REGISTRY=ON)
run(${CMAKE_COMMAND} --build ${WORK}/build)
run(${CMAKE_COMMAND} -E env POLHODE_CACHE=${WORK}/cache ${WORK}/build/consumer)
run(${WORK}/moved/bin/polhode --version)
# what is installed is what polhode.h includes, under one directory; it needs no header of another library
file(GLOB_RECURSE headers RELATIVE ${WORK}/moved/include ${WORK}/moved/include/*)
foreach(header IN LISTS headers)
  if(NOT header MATCHES "^polhode/" OR header MATCHES "mesh|shapes|hull|contact|json|truth/balls|multiprecision")
    message(FATAL_ERROR "${header} is installed")
  endif()
  file(STRINGS ${WORK}/moved/include/${header} foreign REGEX "^#include (\"|<[a-z_]+/)")
  list(FILTER foreign EXCLUDE REGEX "^#include <polhode/")
  if(foreign)
    message(FATAL_ERROR "${header} has ${foreign}")
  endif()
endforeach()
# nothing under the GPL is installed, whatever the build tree has
execute_process(COMMAND ${WORK}/moved/bin/polhode list methods OUTPUT_VARIABLE methods RESULT_VARIABLE result)
if(NOT result EQUAL 0 OR NOT methods MATCHES "cvode_adams" OR methods MATCHES "gsl_")
  message(FATAL_ERROR "the installed program has these methods:\n${methods}")
endif()
