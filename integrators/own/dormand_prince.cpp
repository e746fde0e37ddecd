#include "integrators/own/dormand_prince.h"

namespace polhode {
namespace {

template <class Register>
POLHODE_INLINE void step_by_terms(const RotationCoefficients& coefficients, const RotationAllowance& allowance,
                                  const RotationState& from, double h, Dop853RotationStep& to) {
    switch (coefficients.terms) {
        case RotationTerms::none:
            return dop853_step<RotationTerms::none, Register>(coefficients, allowance, from, h, to);
        case RotationTerms::axial_field:
            return dop853_step<RotationTerms::axial_field, Register>(coefficients, allowance, from, h, to);
        case RotationTerms::quadratic:
            return dop853_step<RotationTerms::quadratic, Register>(coefficients, allowance, from, h, to);
    }
}

}  // namespace

void dop853_step_plain(const RotationCoefficients& coefficients, const RotationAllowance& allowance,
                       const RotationState& from, double h, Dop853RotationStep& to) {
    step_by_terms<LaneHalves>(coefficients, allowance, from, h, to);
}
POLHODE_TARGET_AVX2 void dop853_step_avx2(const RotationCoefficients& coefficients, const RotationAllowance& allowance,
                                          const RotationState& from, double h, Dop853RotationStep& to) {
    step_by_terms<LaneHalves>(coefficients, allowance, from, h, to);
}
POLHODE_TARGET_AVX512 void dop853_step_avx512(const RotationCoefficients& coefficients,
                                              const RotationAllowance& allowance, const RotationState& from, double h,
                                              Dop853RotationStep& to) {
    step_by_terms<Lanes8>(coefficients, allowance, from, h, to);
}

Dop853Step* dop853_step(InstructionSet set) {
    constexpr Dop853Step* all[] = {dop853_step_plain, dop853_step_avx2, dop853_step_avx512};
    return all[static_cast<std::size_t>(set)];
}

}  // namespace polhode
