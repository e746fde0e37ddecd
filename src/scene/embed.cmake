# polhode_embed(OUT FUNCTION DIRECTORY FILE..): writes a source file that defines
#   std::span<const BuiltinText> FUNCTION()
# with one entry a file, named by its path in DIRECTORY without the extension .json, sorted by name. The files' contents
# are dependencies of the configure step, so that an edited scene is in the next build.
function(polhode_embed out function directory)
  set(names "")
  foreach(path IN LISTS ARGN)
    file(RELATIVE_PATH name "${directory}" "${path}")
    string(REGEX REPLACE "\\.json$" "" name "${name}")
    list(APPEND names "${name}")
  endforeach()
  list(SORT names)
  set(entries "")
  set(count 0)
  foreach(name IN LISTS names)
    set(path "${directory}/${name}.json")
    if(NOT EXISTS "${path}")
      set(path "${directory}/${name}")
    endif()
    file(READ "${path}" text)
    string(LENGTH "${text}" length)
    # 65536 is what compilers promise for a string literal
    if(length GREATER 60000)
      message(FATAL_ERROR "${path} has more than 60000 characters: too long to be built in")
    endif()
    string(APPEND entries "    {\"${name}\", R\"polhode(${text})polhode\"},\n")
    math(EXPR count "${count} + 1")
  endforeach()
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${ARGN})
  file(CONFIGURE OUTPUT "${out}" CONTENT [[// generated from experiments/
#include "scene/builtin.h"

namespace polhode {
std::span<const BuiltinText> @function@() {
    static constexpr BuiltinText texts[] = {
@entries@        {"", ""},
    };
    return std::span(texts, @count@);
}
}  // namespace polhode
]] @ONLY)
endfunction()
