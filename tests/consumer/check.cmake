# Installs the build BUILD, moves the installation, builds the consumer against it and runs it.
# Called by ctest with BUILD, SOURCE, WORK, COMPILER, GENERATOR.
cmake_minimum_required(VERSION 3.22)

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
# the method shown in integrators/README.md
file(READ ${SOURCE}/../../integrators/README.md page)
string(REGEX MATCH "```cpp\n([^`]*)```" shown "${page}")
file(WRITE ${WORK}/shown.cpp "#include <polhode/polhode.h>\nnamespace polhode {\n${CMAKE_MATCH_1}}\n")
run(${CMAKE_COMMAND} -S ${SOURCE} -B ${WORK}/build -G ${GENERATOR} -DCMAKE_BUILD_TYPE=Release
  -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_PREFIX_PATH=${WORK}/moved
  -DCMAKE_FIND_PACKAGE_NO_PACKAGE_REGISTRY=ON -DMETHOD_SHOWN=${WORK}/shown.cpp)
run(${CMAKE_COMMAND} --build ${WORK}/build)
run(${CMAKE_COMMAND} -E env POLHODE_CACHE=${WORK}/cache ${WORK}/build/consumer)
run(${WORK}/build/snippet)
run(${WORK}/moved/bin/polhode --version)
# a user-defined method in the tables of an experiment, with its observed order
run(${CMAKE_COMMAND} -E env POLHODE_CACHE=${WORK}/cache ${WORK}/build/laboratory run ${SOURCE}/heun.json --quiet
  --output ${WORK}/results)
file(STRINGS ${WORK}/results/heun_orders.csv orders REGEX "lagrange_top.*,heun,step,2,(1\\.9|2\\.0)")
if(NOT orders)
  file(READ ${WORK}/results/heun_orders.csv orders)
  message(FATAL_ERROR "heun does not have order 2: ${orders}")
endif()
# manual pages, bash completions and scenes are installed
file(GLOB pages RELATIVE ${WORK}/moved/share/man/man1 ${WORK}/moved/share/man/man1/*.1)
foreach(page polhode.1 polhode-solve.1 polhode-check.1)
  if(NOT page IN_LIST pages)
    message(FATAL_ERROR "${page} is not installed; installed pages: ${pages}")
  endif()
endforeach()
run(bash -n ${WORK}/moved/share/bash-completion/completions/polhode)
execute_process(COMMAND bash -c "source ${WORK}/moved/share/bash-completion/completions/polhode
  COMP_WORDS=(${WORK}/moved/bin/polhode check --max-a) COMP_CWORD=2 && _polhode && echo \${COMPREPLY[*]}"
  OUTPUT_VARIABLE completed RESULT_VARIABLE result)
if(NOT completed MATCHES "--max-attitude")
  message(FATAL_ERROR "--max-a is completed to ${completed}, not to --max-attitude")
endif()
run(${WORK}/moved/bin/polhode describe ${WORK}/moved/share/polhode/experiments/scenes/t_handle.json --output ${WORK}/page)
# uninstalling removes all files
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/again)
run(${CMAKE_COMMAND} -DMANIFEST=${BUILD}/install_manifest.txt -P ${SOURCE}/../../src/uninstall.cmake)
file(GLOB_RECURSE left ${WORK}/again/*)
if(left)
  message(FATAL_ERROR "files remain after uninstalling: ${left}")
endif()
# only headers that polhode.h includes are installed, in one directory; they include no header of another library
file(GLOB_RECURSE headers RELATIVE ${WORK}/moved/include ${WORK}/moved/include/*)
foreach(header IN LISTS headers)
  if(NOT header MATCHES "^polhode/" OR header MATCHES "mesh|shapes|hull|contact|json|truth/balls|multiprecision")
    message(FATAL_ERROR "${header} is installed, but not public")
  endif()
  file(STRINGS ${WORK}/moved/include/${header} foreign REGEX "^#include (\"|<[a-z_]+/)")
  list(FILTER foreign EXCLUDE REGEX "^#include <polhode/")
  if(foreign)
    message(FATAL_ERROR "${header} includes headers of other libraries: ${foreign}")
  endif()
endforeach()
# nothing under the GPL is installed, even if the build tree contains it
execute_process(COMMAND ${WORK}/moved/bin/polhode list methods OUTPUT_VARIABLE methods RESULT_VARIABLE result)
if(NOT result EQUAL 0 OR NOT methods MATCHES "cvode_adams" OR methods MATCHES "gsl_")
  message(FATAL_ERROR "the installed program lacks cvode_adams or has methods of GSL:\n${methods}")
endif()
