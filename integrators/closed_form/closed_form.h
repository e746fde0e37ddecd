// Selects the closed form of a piece of motion from its forcing and initial state.
#pragma once

#include <algorithm>
#include <optional>
#include <type_traits>
#include <utility>
#include <variant>

#include "integrators/closed_form/free_body.h"
#include "integrators/closed_form/lagrange_top.h"
#include "motion/equations.h"

namespace polhode {

/// A rotation in closed form, in principal axes: a free body, Lagrange's top, or rotation about one axis under a
/// constant torque and linear drag.
template <class S>
class ClosedForm {
  public:
    /// Returns the closed form, or nullopt if the motion has none. `forcing` is in principal axes. `rounding`:
    /// relative size below which differences count as rounding of computed principal axes; 0 if these are exact.
    static std::optional<ClosedForm> find(const Vector3<S>& moments, const Forcing<S>& forcing, const Vector3<S>& w,
                                          const Quaternion<S>& q, const S& rounding) {
        if (!forcing.springs.empty() || !forcing.world_points.empty() || !forcing.user_torques.empty()) return {};
        if (!forcing.any_torque()) return free_body(moments, w, q);
        if (!forcing.any_torque_beside_field()) return top(moments, forcing, w, q, rounding);
        if (!forcing.body_points.empty()) return {};
        return about_axis(moments, forcing, w, q, rounding);
    }

    /// Constructs the form F in place from the arguments, because forms are large.
    template <class F, class... Arguments>
    explicit ClosedForm(std::in_place_type_t<F> form, Arguments&&... arguments)
        : form_(form, std::forward<Arguments>(arguments)...) {}

    /// Rotation at time t (s) from the start of the piece; t may be negative.
    Rotation<S> at(const S& t) const {
        return std::visit([&](const auto& form) { return form.at(t); }, form_);
    }

  private:
    using Form = std::variant<AxisRotation<S>, FreeSymmetricBody<S>, FreeAsymmetricBody<S>, LagrangeTop<S>>;
    Form form_;

    template <class F, class... Arguments>
    static std::optional<ClosedForm> make(Arguments&&... arguments) {
        return std::optional<ClosedForm>(std::in_place, std::in_place_type<F>, std::forward<Arguments>(arguments)...);
    }

    static S size(const S& x) { return Elementary<S>::magnitude(x); }
    static Vector3<S> unit(int axis) {
        Vector3<S> e;
        e[axis] = S(1);
        return e;
    }
    // Returns the axis that v is parallel to, or -1; 0 for a zero vector.
    static int axis_of(const Vector3<S>& v, const S& rounding) {
        for (int i = 0; i < 3; ++i)
            if (size(v[(i + 1) % 3]) <= rounding * size(v[i]) && size(v[(i + 2) % 3]) <= rounding * size(v[i]))
                return i;
        return -1;
    }
    // Returns the axis of symmetry, or -1.
    static int symmetry_axis(const Vector3<S>& moments, const S& rounding) {
        for (int i = 2; i >= 0; --i)
            if (size(moments[(i + 1) % 3] - moments[(i + 2) % 3]) <= rounding * moments[(i + 1) % 3]) return i;
        return -1;
    }

    static std::optional<ClosedForm> free_body(const Vector3<S>& moments, const Vector3<S>& w, const Quaternion<S>& q) {
        if (const int axis = axis_of(w, S(0)); axis >= 0) return make<AxisRotation<S>>(unit(axis), w[axis], q);
        if (moments[0] == moments[1] && moments[1] == moments[2]) {
            const S rate = length(w);
            return make<AxisRotation<S>>((S(1) / rate) * w, rate, q);
        }
        if (const int axis = symmetry_axis(moments, S(0)); axis >= 0)
            return make<FreeSymmetricBody<S>>(axis, moments[(axis + 1) % 3], moments[axis], w, q);
        if constexpr (std::is_same_v<S, double>)
            if (!is_in_square_range(moments, w))
                return make<FreeAsymmetricBody<double>>(
                    FreeAsymmetricBody<Wide>(cast<Wide>(moments), cast<Wide>(w), cast<Wide>(q)));
        return make<FreeAsymmetricBody<S>>(moments, w, q);
    }

    // Whether squares and fourth powers neither overflow nor underflow in binary64. If not, Wide is used for its
    // larger exponent range.
    static bool is_in_square_range(const Vector3<double>& moments, const Vector3<double>& w) {
        constexpr double most = 1e60, least = 1e-60;
        double largest = 0;
        for (int i = 0; i < 3; ++i) largest = std::max(largest, std::abs(w[i]));
        bool all = largest > least && largest < most;
        for (int i = 0; i < 3; ++i) {
            all = all && moments[i] > least && moments[i] < most;
            all = all && (w[i] == 0 || std::abs(w[i]) > 1e-100 * largest);
        }
        return all;
    }

    // World-fixed forces at points of the symmetry axis. The torque is e x R^T G with G = sum of (arm along the axis)
    // F.
    static std::optional<ClosedForm> top(const Vector3<S>& moments, const Forcing<S>& forcing, const Vector3<S>& w,
                                         const Quaternion<S>& q, const S& rounding) {
        int axis = symmetry_axis(moments, rounding);
        if (axis < 0) return {};
        const bool sphere = size(moments[axis] - moments[(axis + 1) % 3]) <= rounding * moments[axis];
        Vector3<S> field;
        bool first = true;
        for (int b = 0; b < 3; ++b) {
            if (!forcing.field.present[b]) continue;
            const int along = axis_of(forcing.field.moment[b], rounding);
            if (along < 0 || (along != axis && !(sphere && first))) return {};
            axis = along, first = false;
            field[b] = forcing.field.moment[b][axis];
        }
        const Vector3<S> torque_B = rotate_back(q, field);
        const int i = (axis + 1) % 3, j = (axis + 2) % 3;
        const bool upright = torque_B[i] == 0 && torque_B[j] == 0 && w[i] == 0 && w[j] == 0;
        if (upright) return make<AxisRotation<S>>(unit(axis), w[axis], q);
        if constexpr (std::is_same_v<S, double>) {
            const LagrangeStart<Wide> start(axis, moments[i], moments[axis], cast<Wide>(field), cast<Wide>(w),
                                            cast<Wide>(q));
            return make<LagrangeTop<double>>(LagrangeStart<double>(start), q);
        } else {
            return make<LagrangeTop<S>>(axis, moments[i], moments[axis], field, w, q);
        }
    }

    // Rotation about one axis: w, I w, a torque constant in the body or in the world, and the damping of w are all
    // parallel to it.
    static std::optional<ClosedForm> about_axis(const Vector3<S>& moments, const Forcing<S>& forcing,
                                                const Vector3<S>& w, const Quaternion<S>& q, const S& rounding) {
        Vector3<S> torque;
        if (forcing.has_torque) torque = forcing.torque;
        if (forcing.has_world_torque) torque = torque + rotate_back(q, forcing.torque_W);
        const Matrix3<S> damping = forcing.has_damping ? forcing.damping : Matrix3<S>{};
        const bool sphere = moments[0] == moments[1] && moments[1] == moments[2];
        const Vector3<S> direction = w == Vector3<S>() ? torque : w;
        Vector3<S> e;
        if (const int axis = axis_of(direction, rounding); axis >= 0)
            e = unit(axis);
        else if (sphere)
            e = (S(1) / length(direction)) * direction;
        else
            return {};
        const auto along = [&](const Vector3<S>& v) {
            const Vector3<S> across = v - dot(v, e) * e;
            return length(across) <= (rounding + S(4) * Elementary<S>::epsilon()) * length(v);
        };
        const Vector3<S> damped = damping * e;
        if (!along(torque) || !along(w) || !along(damped)) return {};
        const S inverse_moment = S(1) / dot(e, Vector3<S>(moments[0] * e[0], moments[1] * e[1], moments[2] * e[2]));
        return make<AxisRotation<S>>(e, dot(w, e), q, inverse_moment * dot(torque, e), inverse_moment * dot(damped, e));
    }
};

}  // namespace polhode
