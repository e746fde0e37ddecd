#include "integrators/own/midpoint_columns.h"

namespace polhode {

POLHODE_TARGET_AVX512 void midpoint_step_avx512(const RotationCoefficients& coefficients,
                                                const RotationAllowance& allowance, const RotationState& from, double H,
                                                int row, RotationStep& to) {
#ifdef __OPTIMIZE__
    midpoint_step<Lanes8>(coefficients, allowance, from, H, row, to);
#else
    // Same bits. Without optimisation, instantiating every row takes a minute to compile.
    midpoint_step_plain(coefficients, allowance, from, H, row, to);
#endif
}

}  // namespace polhode
