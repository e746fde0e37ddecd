#include "integrators/kernels/midpoint_columns.h"

namespace polhode {

POLHODE_TARGET_AVX512 void midpoint_step_avx512(const RotationCoefficients& coefficients, const RotationAllowance& allowance,
    const RotationState& from, double H, int row, RotationStep& to) {
    midpoint_step<Lanes8>(coefficients, allowance, from, H, row, to);
}

}  // namespace polhode
