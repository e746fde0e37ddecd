// Sines and cosines of numbers side by side: what they are written to is none of what they are read from.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "integrators/lanes/lane_math.h"
#include "integrators/tape/tape_interpreter.h"

namespace polhode {
namespace {

/// Whether an angle is too large for it.
POLHODE_INLINE bool find(const double* x, double* sines, double* cosines) {
    Octet angle, sine, cosine;
    std::memcpy(&angle.v, x, sizeof angle.v);
    sine_cosine(angle, sine, cosine);
    std::memcpy(sines, &sine.v, sizeof sine.v), std::memcpy(cosines, &cosine.v, sizeof cosine.v);
    // also of what is not a number
    return any({~(magnitude(angle).v <= largest_angle)});
}
using Find = bool(const double*, double*, double*);
bool find_plain(const double* x, double* sines, double* cosines) { return find(x, sines, cosines); }
POLHODE_TARGET_AVX2 bool find_avx2(const double* x, double* sines, double* cosines) { return find(x, sines, cosines); }
POLHODE_TARGET_AVX512 bool find_avx512(const double* x, double* sines, double* cosines) {
    return find(x, sines, cosines);
}

}  // namespace

void sines_cosines_of_eight(const double* x, double* sines, double* cosines) {
    constexpr Find* all[] = {find_plain, find_avx2, find_avx512};
    static Find* const find_all = all[static_cast<std::size_t>(instruction_set())];
    if (!find_all(x, sines, cosines)) return;
    for (int i = 0; i < 8; ++i)
        if (!(std::abs(x[i]) <= largest_angle)) sines[i] = std::sin(x[i]), cosines[i] = std::cos(x[i]);
}

void sines_cosines_of_four(const double* x, double* sines, double* cosines) {
    double angle[8]{}, sine[8], cosine[8];
    std::copy_n(x, 4, angle);
    sines_cosines_of_eight(angle, sine, cosine);
    std::copy_n(sine, 4, sines), std::copy_n(cosine, 4, cosines);
}

}  // namespace polhode
