// The step without wide registers. It performs the same operations in every column, one column after another, in a
// loop rather than in code instantiated for each row.
#include "integrators/own/midpoint_columns.h"

namespace polhode {
namespace {

using Register = LaneHalves;

template <RotationTerms terms, bool careful>
void step_column_by_column(const RotationCoefficients& coefficients, const RotationAllowance& allowance,
                           const RotationState& from, double H, int number, RotationStep& to) {
    const ExtrapolationRow& row = extrapolation_rows[number];
    const int K = row.columns;
    const Register y = loaded<Register>(from.y), zero = broadcast<Register>(0);
    const ColumnRuleFor<terms, careful, Register> rule(coefficients, y);
    const double inverse_H = 1 / H;
    Register column[max_columns]{}, lost_column[max_columns]{};
    for (int j = 0; j < K; ++j) {
        const double h = H / row.substeps[j];
        const auto at = rule.column(h);
        Register before = zero, now = rule.first(at, h), lost_before = zero, lost = zero;
        for (int m = 1; m < row.substeps[j]; ++m) {
            Register change = rule.change(at, careful ? now + lost : now);
            if (careful) change = change + lost_before;
            const Register next = before + change;
            if (careful) lost_before = lost, lost = rounded_away(before, change, next);
            before = now, now = next;
        }
        column[j] = rule.increment(now, row.substeps[j] * inverse_H), lost_column[j] = lost;
    }
    const Register& finest = column[K - 1];
    Register value = zero, error = zero, error_before = zero;
    for (int j = 0; j + 1 < K; ++j) {
        Register difference = column[j] - finest;
        if (careful) difference = difference + (lost_column[j] - lost_column[K - 1]);
        value = value + broadcast<Register>(row.weights.value[j]) * difference;
        error = error + broadcast<Register>(row.weights.error[j]) * difference;
        error_before = error_before + broadcast<Register>(row.weights.error_before[j]) * difference;
    }
    if (careful) value = value + lost_column[K - 1];
    finish_step(allowance, from, y, finest, value, error, error_before, row.amplification, to);
}

template <RotationTerms terms>
void step_column_by_column(const RotationCoefficients& coefficients, const RotationAllowance& allowance,
                           const RotationState& from, double H, int row, RotationStep& to) {
    const auto step = row == compensated_row ? step_column_by_column<terms, true> : step_column_by_column<terms, false>;
    step(coefficients, allowance, from, H, row, to);
}

}  // namespace

void midpoint_step_plain(const RotationCoefficients& coefficients, const RotationAllowance& allowance,
                         const RotationState& from, double H, int row, RotationStep& to) {
    switch (coefficients.terms) {
        case RotationTerms::none:
            return step_column_by_column<RotationTerms::none>(coefficients, allowance, from, H, row, to);
        case RotationTerms::axial_field:
            return step_column_by_column<RotationTerms::axial_field>(coefficients, allowance, from, H, row, to);
        case RotationTerms::quadratic:
            return step_column_by_column<RotationTerms::quadratic>(coefficients, allowance, from, H, row, to);
    }
}

MidpointStep* midpoint_step(InstructionSet set) {
    constexpr MidpointStep* all[] = {midpoint_step_plain, midpoint_step_avx2, midpoint_step_avx512};
    return all[static_cast<std::size_t>(set)];
}

}  // namespace polhode
