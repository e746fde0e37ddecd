#include "integrators/own/octets.h"

namespace polhode {
namespace {

POLHODE_INLINE void advance_all(FreeOctet* octets, std::size_t count, double t) {
    for (std::size_t i = 0; i < count; ++i) advance_free(octets[i], t);
}
void free_plain(FreeOctet* octets, std::size_t count, double t) { advance_all(octets, count, t); }
POLHODE_TARGET_AVX2 void free_avx2(FreeOctet* octets, std::size_t count, double t) { advance_all(octets, count, t); }
POLHODE_TARGET_AVX512 void free_avx512(FreeOctet* octets, std::size_t count, double t) {
    advance_all(octets, count, t);
}

}  // namespace

void advance_free_octets(FreeOctet* octets, std::size_t count, double t, InstructionSet set) {
    constexpr void (*all[])(FreeOctet*, std::size_t, double) = {free_plain, free_avx2, free_avx512};
    all[static_cast<std::size_t>(set)](octets, count, t);
}

}  // namespace polhode
