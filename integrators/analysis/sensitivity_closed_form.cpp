#include "integrators/analysis/sensitivity_closed_form.h"

#include <array>
#include <optional>
#include <utility>

#include "integrators/closed_form/closed_form.h"

namespace polhode {
namespace {

using Form = ClosedForm<Wide>;
constexpr int directions = 6;
constexpr double initial_shift = 1e-16;

// q rotated by the rotation vector a in body axes; |a|^2 must be negligible
Quaternion<Wide> rotate_slightly(const Quaternion<Wide>& q, const Vector3<Wide>& a) {
    return normalized(q * Quaternion<Wide>{1, a[0] / 2, a[1] / 2, a[2] / 2});
}

// rotation vector from a to b; its square must be negligible
Vector3<Wide> rotation_between(const Quaternion<Wide>& a, const Quaternion<Wide>& b) {
    const Quaternion<Wide> d = conjugate(a) * b;
    const Wide twice = d.w < 0 ? -2 : 2;
    return {twice * d.x, twice * d.y, twice * d.z};
}

}  // namespace

std::vector<Eigen::Matrix<double, 6, 6>> sensitivity_by_closed_form(const Problem& problem,
                                                                    const std::vector<double>& times) {
    if (problem.segments.size() != 1 || !problem.segments.front().impulses.empty() || problem.needs.user_torque ||
        problem.needs.translation == Translation::integrated)
        return {};
    const WidePrincipalFrame& frame = problem.body.wide_principal;
    const ExactBody<Wide> body = exact_body<Wide>(problem.scene);
    const Forcing<Wide> forcing = forcing_at<Wide>(problem.scene, body, 0, frame.q_BP);
    const Vector3<Wide>& w = problem.body.wide_initial_angular_velocity;
    const Quaternion<Wide> q = body.q * frame.q_BP;
    const Wide scale = problem.scales.angular_velocity;

    // closed forms of the motions on either side of the start
    std::vector<std::pair<Form, Form>> neighbours;
    for (int k = 0; k < directions; ++k) {
        const auto moved = [&](const Wide& by) {
            Vector3<Wide> a, b;
            (k < 3 ? a : b)[k % 3] = by;
            return Form::find(frame.moments, forcing, w + scale * b, rotate_slightly(q, a), Wide(0x1p-100));
        };
        const std::optional<Form> after = moved(initial_shift), before = moved(-initial_shift);
        if (!after || !before) return {};
        neighbours.emplace_back(*before, *after);
    }
    std::vector<Eigen::Matrix<double, 6, 6>> result;
    for (const double t : times) {
        Eigen::Matrix<double, 6, 6>& S = result.emplace_back();
        for (int k = 0; k < directions; ++k) {
            const Rotation<Wide> before = neighbours[k].first.at(t), after = neighbours[k].second.at(t);
            const Vector3<Wide> rotation = rotation_between(before.q, after.q), change = after.w - before.w;
            for (int i = 0; i < 3; ++i) {
                S(i, k) = static_cast<double>(rotation[i] / (2 * initial_shift));
                S(3 + i, k) = static_cast<double>(change[i] / (2 * initial_shift * scale));
            }
        }
    }
    return result;
}

}  // namespace polhode
