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
run(${WORK}/build/consumer)
run(${WORK}/moved/bin/polhode --version)
# nothing under the GPL is installed, whatever the build tree has
execute_process(COMMAND ${WORK}/moved/bin/polhode list methods OUTPUT_VARIABLE methods RESULT_VARIABLE result)
if(NOT result EQUAL 0 OR NOT methods MATCHES "cvode_adams" OR methods MATCHES "gsl_")
  message(FATAL_ERROR "the installed program has these methods:\n${methods}")
endif()
