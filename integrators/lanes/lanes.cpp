#include "integrators/lanes/lanes.h"

#include <algorithm>
#include <array>
#include <cstdlib>

namespace polhode {
namespace {

constexpr std::array<std::string_view, 3> names{"plain", "avx2", "avx512"};

InstructionSet requested_instruction_set() {
    const char* const setting = std::getenv("POLHODE_INSTRUCTION_SET");
    for (std::size_t i = 0; setting && i < names.size(); ++i)
        if (names[i] == setting) return static_cast<InstructionSet>(i);
    return InstructionSet::avx512;
}

}  // namespace

std::string_view name_of(InstructionSet set) { return names[static_cast<std::size_t>(set)]; }

InstructionSet widest_instruction_set() {
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl") &&
        __builtin_cpu_supports("fma"))
        return InstructionSet::avx512;
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return InstructionSet::avx2;
#endif
    return InstructionSet::plain;
}

InstructionSet instruction_set() {
    static const InstructionSet set = std::min(widest_instruction_set(), requested_instruction_set());
    return set;
}

}  // namespace polhode
