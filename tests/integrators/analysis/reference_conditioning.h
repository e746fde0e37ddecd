// Reference values for conditioning(): motion and derivatives by multiprecision Taylor series.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "integrators/analysis/conditioning.h"
#include "integrators/analysis/spectral_norm.h"
#include "integrators/series/linear_algebra.h"
#include "integrators/truth/taylor.h"
#include "motion/body_equations.h"
#include "motion/dual.h"
#include "motion/exact_body_of.h"
#include "motion/problem.h"

namespace polhode::truth {

// The motion followed by the columns of its derivative with respect to the initial state: a rotation about each body
// axis, a change of w along each body axis, and of p and v along each world axis if translation counts. Each column
// has the layout of motion/systems.h.
template <class P, bool translation>
class VariationalForm {
  public:
    static constexpr int columns = translation ? 12 : 6, rows = columns + 1;
    using Derivative = Eigen::Matrix<P, columns, columns>;

    explicit VariationalForm(const Scene& scene)
        : scene_(&scene), body_(exact_body<P>(scene)), inertia_{body_.inertia_B, inverse(body_.inertia_B)} {}

    int dimension() const { return rows * (1 + columns); }

    std::vector<Block> blocks(const Scales& scales, const Vector3<double>&) const {
        std::vector<Block> blocks;
        for (int j = 0; j <= columns; ++j) {
            const int first = rows * j;
            blocks.insert(blocks.end(), {{first, 3, scales.angular_velocity}, {first + 3, 4, 1}});
            if constexpr (translation)
                blocks.insert(blocks.end(), {{first + 7, 3, scales.position}, {first + 10, 3, scales.velocity}});
        }
        return blocks;
    }

    void initial(P* y) const {
        for (int i = 0; i < dimension(); ++i) y[i] = 0;
        put(y, 0, body_.angular_velocity_B);
        put(y, 3, body_.q);
        if constexpr (translation) put(y, 7, body_.position_W), put(y, 10, body_.velocity_W);
        for (int j = 0; j < columns; ++j) {
            P* column = y + rows * (1 + j);
            Vector3<P> turn;
            if (j < 3)
                turn[j] = P(1), put(column, 3, attitude_rate(P(0.5), body_.q, turn));
            else
                column[j < 6 ? j - 3 : j + 1] = 1;
        }
    }

    void enter(double begin, P* y) {
        forcing_ = forcing_at<P>(*scene_, body_, begin, Quaternion<P>{});
        for (const PosedImpulse<P>& impulse : impulses_at<P>(*scene_, body_, begin, Quaternion<P>{})) {
            using D = Dual<columns, P>;
            std::array<D, rows> moved = tangents<D>(y);
            Vector3<D> w = vector_at(moved.data(), 0), p, v;
            if constexpr (translation) p = vector_at(moved.data(), 7), v = vector_at(moved.data(), 10);
            const FullInertia<D> inertia{cast<D>(inertia_.tensor), cast<D>(inertia_.inverse)};
            apply<D>({cast<D>(impulse.vector), impulse.frame, cast<D>(impulse.point), impulse.point_frame}, inertia,
                     D(body_.mass), body_.pivoted, w, quaternion_at(moved.data(), 3), p, v);
            put(moved.data(), 0, w);
            if constexpr (translation) put(moved.data(), 10, v);
            flatten(moved, y);
        }
    }

    template <class S>
    void derivative(const S* y, S* dy) const {
        using D = Dual<columns, S, P>;
        const std::array<D, rows> moved = tangents<D>(y);
        std::array<D, rows> rate;
        LoadedEquations<P, FullInertia<P>, translation>{inertia_, &forcing_}.derivative(0, moved.data(), rate.data());
        flatten(rate, dy);
    }

    /// The derivative of w, the attitude (rad), p and v, in SI units.
    Derivative motion(const P* y) const {
        const Quaternion<P> q = quaternion_at(y, 3);
        const P twice = P(2) / squared_norm(q);
        Derivative S;
        for (int j = 0; j < columns; ++j) {
            const P* column = y + rows * (1 + j);
            const Vector3<P> turn = twice * vector_part(conjugate(q) * quaternion_at(column, 3));
            for (int i = 0; i < columns; ++i) S(i, j) = i < 3 ? turn[i] : column[i < 6 ? i - 3 : i + 1];
        }
        return S;
    }

  private:
    template <class D, class S>
    static std::array<D, rows> tangents(const S* y) {
        std::array<D, rows> moved;
        for (int i = 0; i < rows; ++i) {
            moved[i].value = y[i];
            for (int j = 0; j < columns; ++j) moved[i].slope[j] = y[rows * (1 + j) + i];
        }
        return moved;
    }
    template <class D, class S>
    static void flatten(const std::array<D, rows>& moved, S* y) {
        for (int i = 0; i < rows; ++i) {
            y[i] = moved[i].value;
            for (int j = 0; j < columns; ++j) y[rows * (1 + j) + i] = moved[i].slope[j];
        }
    }

    const Scene* scene_;
    ExactBody<P> body_;
    FullInertia<P> inertia_;
    Forcing<P> forcing_;
};

template <bool translation>
Conditioning run(const Problem& problem, const std::vector<double>& times, int digits, long max_steps) {
    using P = Real<50>;
    using Form = VariationalForm<P, translation>;
    const TaylorSettings settings{static_cast<int>(std::ceil(1.15 * digits)) + 2, static_cast<double>(digits), 1,
                                  max_steps};
    const auto run = taylor<P, Form>(problem.scene, times, problem.scales, problem.body.principal.moments, settings);
    Conditioning result;
    result.steps = run.steps;
    std::array<double, Form::columns> scale{};
    for (int i = 0; i < Form::columns; ++i)
        scale[i] = i < 3   ? 1
                   : i < 6 ? problem.scales.angular_velocity
                   : i < 9 ? problem.scales.position
                           : problem.scales.velocity;
    for (const auto& exact : run.motions) {
        Eigen::Matrix<double, Form::columns, Form::columns> S;
        for (int i = 0; i < Form::columns; ++i)
            for (int j = 0; j < Form::columns; ++j)
                S(i, j) = P(exact(i, j) * scale[j] / scale[i]).template convert_to<double>();
        const Eigen::Matrix<double, 3, Form::columns> attitude = S.template topRows<3>();
        result.times.push_back(times[result.times.size()]);
        result.state.push_back(spectral_norm(S)), result.attitude.push_back(spectral_norm(attitude));
    }
    result.available = run.fault.empty() && result.times.size() == times.size();
    result.message = run.fault.empty()
                         ? fmt::format("Taylor series of order {} in 50 digits, {} steps", settings.order, run.steps)
                         : run.fault;
    return result;
}

}  // namespace polhode::truth

namespace polhode {

/// kappa as defined for conditioning(), computed independently: the variational equation of the full right-hand side,
/// with the full tensor in body axes, in 50 digits, by Taylor series with a local error of 10^-digits. It follows
/// motions that binary64 cannot, until kappa approaches 10^digits, and takes seconds where conditioning() takes
/// milliseconds. Translation is integrated wherever the centre of mass moves. `available` is false for user-defined
/// torques and stiff scenes. Throws std::invalid_argument on invalid times.
inline Conditioning reference_conditioning(const Problem& problem, const std::vector<double>& times, int digits = 20,
                                           long max_steps = 20'000) {
    if (problem.formulation != Formulation::reduced)
        return reference_conditioning(pose(problem.scene), times, digits, max_steps);
    if (times.empty() || times.front() < 0 || !(times.back() <= problem.scene.duration) ||
        !std::is_sorted(times.begin(), times.end()))
        throw std::invalid_argument("times must be within the duration and not decreasing");
    if (problem.needs.user_torque || !problem.scene.planes.empty()) {
        Conditioning none;
        none.message = problem.needs.user_torque ? "user-defined torques have no Taylor series"
                                                 : "conditioning through impacts on planes is not supported";
        return none;
    }
    return problem.needs.translation == Translation::fixed ? truth::run<false>(problem, times, digits, max_steps)
                                                           : truth::run<true>(problem, times, digits, max_steps);
}

}  // namespace polhode
