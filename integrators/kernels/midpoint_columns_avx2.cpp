#include "integrators/kernels/midpoint_columns.h"

namespace polhode {

POLHODE_TARGET_AVX2 void midpoint_step_avx2(const RotationCoefficients& coefficients, const RotationAllowance& allowance,
    const RotationState& from, double H, int row, RotationStep& to) {
    midpoint_step<LaneHalves>(coefficients, allowance, from, H, row, to);
}

}  // namespace polhode
