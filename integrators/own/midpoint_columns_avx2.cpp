#include "integrators/own/midpoint_columns.h"

namespace polhode {

POLHODE_TARGET_AVX2 void midpoint_step_avx2(const RotationCoefficients& coefficients,
                                            const RotationAllowance& allowance, const RotationState& from, double H,
                                            int row, RotationStep& to) {
#ifdef __OPTIMIZE__
    midpoint_step<LaneHalves>(coefficients, allowance, from, H, row, to);
#else
    // the same bits; written out for every row without optimisation it takes a minute to compile
    midpoint_step_plain(coefficients, allowance, from, H, row, to);
#endif
}

}  // namespace polhode
