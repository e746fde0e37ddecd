// The rules that a body of an ensemble keeps, and tables that are read whole.
#include "motion/ensemble_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "body/fast_principal_frame.h"
#include "motion/ensemble_stream.h"
#include "text/decimal.h"

namespace polhode {
namespace {

constexpr double norm_tolerance = 1e-6, shape_tolerance = 1e-12;

bool is_diagonal(const Matrix3<double>& J) {
    return J[0][1] == 0 && J[0][2] == 0 && J[1][2] == 0 && J[1][0] == 0 && J[2][0] == 0 && J[2][1] == 0;
}

// Whether a body in its principal axes satisfies all rules with a margin. Most bodies do; this test is ten times
// faster.
bool is_plain(const EnsembleBody& b, bool pivoted) {
    constexpr double least = 1e-300, most = 1e300;  // both have inverses
    const Vector3<double>&w = b.angular_velocity, &p = b.position_W, &v = b.velocity_W;
    const double I[3] = {b.inertia_B[0][0], b.inertia_B[1][1], b.inertia_B[2][2]};
    // not a number where one of them is not finite
    const double zero = (w[0] + w[1] + w[2]) * 0 + (p[0] + p[1] + p[2]) * 0 + (v[0] + v[1] + v[2]) * 0;
    return !pivoted && is_diagonal(b.inertia_B) && b.mass >= least && b.mass <= most &&
           std::abs(squared_norm(b.orientation) - 1) <= norm_tolerance && zero == 0 && I[0] >= least && I[1] >= least &&
           I[2] >= least && I[0] <= most && I[1] <= most && I[2] <= most && I[0] <= I[1] + I[2] &&
           I[1] <= I[2] + I[0] && I[2] <= I[0] + I[1];
}

}  // namespace

EnsembleBody ensemble_body(const Scene& scene) {
    return {scene.body.mass,           scene.body.inertia_B,
            scene.initial.orientation, scene.initial.angular_velocity,
            scene.initial.position_W,  scene.initial.velocity_W};
}

std::optional<BodyFault> fault_of(const EnsembleBody& b, bool pivoted) {
    if (is_plain(b, pivoted)) return {};
    const auto finite = [](double x) { return x * 0 == 0; };
    const auto all_finite = [&](const Vector3<double>& x) { return finite(x[0]) && finite(x[1]) && finite(x[2]); };
    if (!(b.mass > 0) || !finite(b.mass) || !finite(1 / b.mass))
        return BodyFault{"mass", "is " + shortest_decimal(b.mass), "the mass must be finite and > 0"};
    const Quaternion<double>& q = b.orientation;
    const double norm = std::sqrt(squared_norm(q));
    if (!(std::abs(norm - 1) <= norm_tolerance))
        return BodyFault{"qw,qx,qy,qz", "have norm " + shortest_decimal(norm),
                         "give a unit quaternion w, x, y, z with norm 1 within 1e-6"};
    if (!all_finite(b.angular_velocity)) return BodyFault{"wx,wy,wz", "are not finite", "give finite numbers"};
    if (!all_finite(b.position_W)) return BodyFault{"px,py,pz", "are not finite", "give finite numbers"};
    if (!all_finite(b.velocity_W)) return BodyFault{"vx,vy,vz", "are not finite", "give finite numbers"};
    if (pivoted && !(b.position_W == Vector3<double>() && b.velocity_W == Vector3<double>()))
        return BodyFault{"px,py,pz,vx,vy,vz", "are given, but the scene has a pivot",
                         "remove them: the pivot and the attitude determine the centre of mass"};

    const Matrix3<double>& J = b.inertia_B;
    const bool axes_are_principal = is_diagonal(J);
    const char* const columns = axes_are_principal ? "ixx,iyy,izz" : "ixx,iyy,izz,ixy,ixz,iyz";
    for (int i = 0; i < 3; ++i)
        if (!all_finite(J[i])) return BodyFault{columns, "are not finite", "give finite numbers"};
    Vector3<double> I(J[0][0], J[1][1], J[2][2]);
    if (!axes_are_principal) I = fast_principal_frame(J).moments;
    const double largest = std::max({std::abs(I[0]), std::abs(I[1]), std::abs(I[2])});
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < i; ++j)
            if (!(std::abs(J[i][j] - J[j][i]) <= shape_tolerance * largest))
                return BodyFault{columns, "are not symmetric", "the inertia tensor must be symmetric"};
    for (int i = 0; i < 3; ++i) {
        if (!(I[i] > 0) || !finite(I[i]) || !finite(1 / I[i]))
            return BodyFault{columns, fmt::format("result in the principal moment {}", shortest_decimal(I[i])),
                             "every principal moment must be finite and > 0"};
        const double others = I[(i + 1) % 3] + I[(i + 2) % 3];
        if (!(I[i] - others <= shape_tolerance * largest))
            return BodyFault{columns,
                             fmt::format("result in a principal moment {}, more than the sum {} of the other two",
                                         shortest_decimal(I[i]), shortest_decimal(others)),
                             "moments of inertia must satisfy the triangle inequality within 1e-12 of the largest"};
    }
    return {};
}

std::vector<std::size_t> EnsembleTable::row_numbers(std::size_t first) const {
    std::vector<std::size_t> numbers;
    numbers.reserve(rows());
    auto next_refused = refused.begin();
    for (std::size_t number = first; numbers.size() < rows(); ++number)
        if (next_refused != refused.end() && next_refused->row == number)
            ++next_refused;
        else
            numbers.push_back(number);
    return numbers;
}

EnsembleTable parse_ensemble(std::string_view text, const std::string& file, const Scene& scene, BadRows bad) {
    const std::unique_ptr<EnsembleStream> rows = ensemble_of_text(text, file, scene);
    EnsembleTable table;
    rows->next(table, std::numeric_limits<std::size_t>::max(), bad);
    rows->require_rows();
    return table;
}

}  // namespace polhode
