#include "scene/inertia_repair.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "body/mass_properties.h"
#include "body/rigid_body.h"

namespace polhode {
namespace {

constexpr double tolerance = 1e-12;    // relative to the largest moment: rounding in binary64
constexpr double small_excess = 1e-3;  // relative to the largest moment: rounding of printed digits

// Projects x1 <= x2 <= x3 onto the cone x1 + x2 >= x3, x1 + x3 >= x2. These two imply the other conditions: their sum
// gives x1 >= 0, and x2 + x3 >= x1 follows from the order.
void project(std::array<Wide, 3>& x) {
    const Wide excess = x[2] - x[0] - x[1];
    if (!(excess > 0)) return;
    // project onto the plane x1 + x2 = x3, whose normal is (1, 1, -1)
    x[0] += excess / 3, x[1] += excess / 3, x[2] -= excess / 3;
    if (x[0] < 0) {
        // project onto the edge x1 = 0, x2 = x3, the intersection of both planes
        x[0] = 0;
        x[1] = x[2] = (x[1] + x[2]) / 2;
        if (x[1] < 0) x[1] = x[2] = 0;
    }
}

}  // namespace

std::string InertiaRepair::description() const {
    return fmt::format(
        "breaks the triangle inequality: its largest principal moment {:.6g} kg m^2 exceeds the sum of the other two "
        "by "
        "{:.3g} of itself",
        largest, excess);
}

InertiaRepair repair_inertia(const Matrix3<Wide>& inertia) {
    InertiaRepair repair;
    repair.inertia = inertia;
    const WidePrincipalFrame frame = wide_principal_frame(inertia);
    std::array<int, 3> order{0, 1, 2};
    std::sort(order.begin(), order.end(), [&](int a, int b) { return frame.moments[a] < frame.moments[b]; });
    std::array<Wide, 3> x{};
    for (std::size_t i = 0; i < 3; ++i) x[i] = frame.moments[order[i]];
    // negative moments also count as an excess
    const Wide size = std::max(square_root(x[0] * x[0]), square_root(x[2] * x[2]));
    const Wide excess = x[2] - x[0] - x[1];
    repair.largest = double(x[2]);
    if (!(excess > Wide(tolerance) * size)) return repair;
    repair.excess = double(excess / size), repair.is_small = repair.excess <= small_excess;
    const std::array<Wide, 3> given = x;
    project(x);
    Vector3<Wide> moments;
    for (std::size_t i = 0; i < 3; ++i) {
        moments[order[i]] = x[i];
        repair.change = std::max(repair.change, std::abs(double(x[i] - given[i])));
    }
    repair.inertia = rotated(diagonal(moments), frame.q_BP);
    return repair;
}

Matrix3<double> round_tensor(const Matrix3<Wide>& inertia) {
    Matrix3<double> rounded;
    // + 0.0 removes negative zeros
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j <= i; ++j) rounded[i][j] = rounded[j][i] = double(inertia[i][j]) + 0.0;
    return rounded;
}

}  // namespace polhode
