# Run at build time: writes to OUTPUT a FUNCTION, declared in HEADER, that returns the identity of code: of every source
# file in FOLDERS (blanks between them) and of CONFIGURATION (compiler, flags, libraries). With COMMIT, a file, writes the
# commit there; one that changes no source leaves the identity as it is.
#   cmake -DSOURCE=.. -DFOLDERS=.. -DCONFIGURATION=.. -DHEADER=.. -DFUNCTION=.. -DOUTPUT=.. [-DCOMMIT=..] -P source_key.cmake
separate_arguments(FOLDERS)
set(sources "")
foreach(folder IN LISTS FOLDERS)
  file(GLOB_RECURSE found RELATIVE ${SOURCE} ${SOURCE}/${folder}/*.cpp ${SOURCE}/${folder}/*.h)
  file(GLOB drivers RELATIVE ${SOURCE} ${SOURCE}/${folder}/engines/node/*.js)
  list(APPEND sources ${found} ${drivers})
endforeach()
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

# within the namespaces of the name
string(REGEX REPLACE "::[^:]*$" "" namespace ${FUNCTION})
string(REGEX REPLACE ".*::" "" name ${FUNCTION})
write_if_different(${OUTPUT} "#include \"${HEADER}\"

namespace ${namespace} {
const char* ${name}() { return \"${key}\"; }
}  // namespace ${namespace}
")
if(COMMIT)
  execute_process(COMMAND git -C ${SOURCE} describe --always --dirty --abbrev=12
    OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
  if(failed)
    set(commit "unknown")
  endif()
  write_if_different(${COMMIT} "${commit}\n")
endif()
