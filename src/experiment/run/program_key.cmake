# Run at build time: writes the identity of the program's code (every source file, compiler, flags, how SUNDIALS was
# compiled) to OUTPUT, and the commit to COMMIT. A commit that changes no source leaves the identity as it is.
#   cmake -DSOURCE=.. -DCONFIGURATION=.. -DOUTPUT=.. -DCOMMIT=.. -P program_key.cmake
file(GLOB_RECURSE sources RELATIVE ${SOURCE}
  ${SOURCE}/src/*.cpp ${SOURCE}/src/*.h ${SOURCE}/integrators/*.cpp ${SOURCE}/integrators/*.h)
list(SORT sources)
set(all "${CONFIGURATION}\n")
foreach(source IN LISTS sources)
  file(SHA256 ${SOURCE}/${source} hash)
  string(APPEND all "${source} ${hash}\n")
endforeach()
string(SHA256 key "${all}")
string(SUBSTRING ${key} 0 32 key)

function(write_if_different path content)
  set(old "")
  if(EXISTS ${path})
    file(READ ${path} old)
  endif()
  if(NOT old STREQUAL content)
    file(WRITE ${path} "${content}")
  endif()
endfunction()

write_if_different(${OUTPUT} "#include \"experiment/run/case_store.h\"

namespace polhode {
const char* program_key() { return \"${key}\"; }
}  // namespace polhode
")
execute_process(COMMAND git -C ${SOURCE} describe --always --dirty --abbrev=12
  OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
if(failed)
  set(commit "unknown")
endif()
write_if_different(${COMMIT} "${commit}\n")
