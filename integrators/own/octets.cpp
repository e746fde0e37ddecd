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

POLHODE_INLINE void advance_some(LoadedLane* bodies, std::size_t count, const LoadTerms& terms, bool symmetric,
                                 const LaneSteps& steps) {
    using namespace loaded_octet;
    constexpr int order = 20;
    if (symmetric)
        advance_loaded<SymmetricSeries<order>>(bodies, count, terms, steps);
    else if (terms.axes > 0)
        advance_loaded<Series<order, true>>(bodies, count, terms, steps);
    else
        advance_loaded<Series<order, false>>(bodies, count, terms, steps);
}

void loaded_plain(LoadedLane* bodies, std::size_t count, const LoadTerms& terms, bool symmetric,
                  const LaneSteps& steps) {
    advance_some(bodies, count, terms, symmetric, steps);
}
POLHODE_TARGET_AVX2 void loaded_avx2(LoadedLane* bodies, std::size_t count, const LoadTerms& terms, bool symmetric,
                                     const LaneSteps& steps) {
    advance_some(bodies, count, terms, symmetric, steps);
}
POLHODE_TARGET_AVX512 void loaded_avx512(LoadedLane* bodies, std::size_t count, const LoadTerms& terms, bool symmetric,
                                         const LaneSteps& steps) {
    advance_some(bodies, count, terms, symmetric, steps);
}

}  // namespace

void advance_free_octets(FreeOctet* octets, std::size_t count, double t, InstructionSet set) {
    constexpr void (*all[])(FreeOctet*, std::size_t, double) = {free_plain, free_avx2, free_avx512};
    all[static_cast<std::size_t>(set)](octets, count, t);
}

void advance_loaded_lanes(LoadedLane* bodies, std::size_t count, const LoadTerms& terms, bool symmetric,
                          const LaneSteps& steps, InstructionSet set) {
    constexpr void (*all[])(LoadedLane*, std::size_t, const LoadTerms&, bool, const LaneSteps&) = {
        loaded_plain, loaded_avx2, loaded_avx512};
    all[static_cast<std::size_t>(set)](bodies, count, terms, symmetric, steps);
}

}  // namespace polhode
