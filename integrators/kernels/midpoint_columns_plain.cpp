#include "integrators/kernels/midpoint_columns.h"

namespace polhode {

void midpoint_step_plain(const RotationCoefficients& coefficients, const RotationAllowance& allowance,
    const RotationState& from, double H, int row, RotationStep& to) {
    midpoint_step<LaneHalves>(coefficients, allowance, from, H, row, to);
}

MidpointStep* midpoint_step(InstructionSet set) {
    switch (set) {
        case InstructionSet::avx512:
            return midpoint_step_avx512;
        case InstructionSet::avx2:
            return midpoint_step_avx2;
        case InstructionSet::plain:
            break;
    }
    return midpoint_step_plain;
}

}  // namespace polhode
