# polhode_embed(OUT FUNCTION FILE..): writes a source file that defines
#   std::span<const BuiltinText> FUNCTION()
# with one entry a file, named after it without its extension. The files' contents are dependencies of the configure
# step, so that an edited scene is in the next build.
function(polhode_embed out function)
  set(entries "")
  set(count 0)
  foreach(path IN LISTS ARGN)
    get_filename_component(name "${path}" NAME_WLE)
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
namespace {
constexpr BuiltinText texts[] = {
@entries@    {"", ""},
};
}  // namespace

std::span<const BuiltinText> @function@() { return std::span(texts, @count@); }
}  // namespace polhode
]] @ONLY)
endfunction()
