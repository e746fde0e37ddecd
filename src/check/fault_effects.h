// Effects of the faults of check/known_faults.cpp. Each function applies a fault to a sound cause, and returns false
// if the fault has no effect in the scene.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "body/elementary.h"
#include "body/fast_principal_frame.h"
#include "body/mass_properties.h"
#include "body/rigid_body.h"
#include "check/hypothesis.h"

namespace polhode::fault_effects {

inline auto change_reading(void (*change)(Reading&)) {
    return [change](Cause& c, double) {
        change(c.reading);
        return true;
    };
}
inline auto change_engine(void (*change)(EngineFault&, double)) {
    return [change](Cause& c, double x) {
        change(c.engine, x);
        return true;
    };
}

// Whether two tensors are equal, for example after exchanging axes of a symmetric body.
inline bool same_tensor(const Matrix3<double>& a, const Matrix3<double>& b) {
    double change = 0, scale = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            change = std::max(change, std::abs(a[i][j] - b[i][j])), scale = std::max(scale, std::abs(a[i][j]));
    return change <= 1e-6 * scale;
}

inline bool set_tensor(Cause& c, const Matrix3<double>& tensor) {
    if (same_tensor(c.scene.body.inertia_B, tensor)) return false;
    // the tensor is not validated: changed products of inertia can make it invalid for any body
    c.scene.body.inertia_B = tensor;
    return true;
}

// Permutes the rows and columns of the tensor.
template <int a, int b, int c>
bool permute_axes(Cause& cause, double) {
    constexpr std::array order{a, b, c};
    const Matrix3<double> I = cause.scene.body.inertia_B;
    Matrix3<double> permuted;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            permuted[i][j] = I[order[static_cast<std::size_t>(i)]][order[static_cast<std::size_t>(j)]];
    return set_tensor(cause, permuted);
}

inline bool scale_products(Cause& c, double factor) {
    Matrix3<double> I = c.scene.body.inertia_B;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            if (i != j) I[i][j] *= factor;
    return set_tensor(c, I);
}

// Uses R^T D R instead of R D R^T, where R maps principal axes to body axes.
inline bool transpose_principal_frame(Cause& c, double) {
    const PrincipalFrame frame = fast_principal_frame(c.scene.body.inertia_B);
    const Matrix3<double> R = rotation_matrix(frame.q_BP);
    return set_tensor(c, transposed(R) * diagonal(frame.moments) * R);
}

// Uses the principal moments about the body axes.
inline bool drop_principal_frame(Cause& c, double) {
    return set_tensor(c, diagonal(fast_principal_frame(c.scene.body.inertia_B).moments));
}

inline bool mean_moment(Cause& c, double) {
    const Matrix3<double>& I = c.scene.body.inertia_B;
    const double mean = (I[0][0] + I[1][1] + I[2][2]) / 3;
    return set_tensor(c, diagonal(Vector3<double>(mean, mean, mean)));
}

inline bool has_load(const Scene& scene, auto&& is) { return std::any_of(scene.loads.begin(), scene.loads.end(), is); }
template <class T>
bool has(const Scene& scene) {
    return has_load(scene, [](const Load& load) { return std::holds_alternative<T>(load); });
}
template <class T>
void each(Scene& scene, auto&& change) {
    for (Load& load : scene.loads)
        if (T* one = std::get_if<T>(&load)) change(*one);
}

// Whether the scene has torques or forces. A body coasts when none of them acts.
inline bool has_pushes(const Scene& scene) {
    return has<Torque>(scene) || has<Force>(scene) || has<FormulaLoad>(scene);
}

// Whether the size of the moments of inertia matters: only if there are torques.
inline bool torque_matters(const Scene& scene) {
    return has<Torque>(scene) || has<Force>(scene) || has<Impulse>(scene) || has<Spring>(scene) ||
           has<FormulaLoad>(scene) ||
           has_load(scene,
                    [](const Load& load) {
                        const Drag* drag = std::get_if<Drag>(&load);
                        return drag && length(drag->rotational) > 0;
                    }) ||
           (has<Gravity>(scene) && scene.pivot);
}

inline bool scale_inertia(Cause& c, double factor) {
    if (!torque_matters(c.scene)) return false;
    for (Vector3<double>& row : c.scene.body.inertia_B.row) row = factor * row;
    return true;
}

inline bool mass_matters(const Scene& scene) {
    return has<Force>(scene) || has<Impulse>(scene) || has<Drag>(scene) || has<FormulaLoad>(scene) ||
           (scene.pivot && has<Gravity>(scene));
}
inline bool scale_mass(Cause& c, double factor) {
    if (!mass_matters(c.scene)) return false;
    c.scene.body.mass *= factor;
    return true;
}
// A wrong density or unit of mass scales mass and inertia.
inline bool scale_density(Cause& c, double factor) {
    const bool mass = scale_mass(c, factor);
    return scale_inertia(c, factor) || mass;
}

inline bool center_at_origin(Cause& c, double) {
    Body& body = c.scene.body;
    if (!(length(body.center_of_mass) > 0)) return false;
    body.center_of_mass = {};
    return true;
}
inline bool inertia_about_origin(Cause& c, double) {
    Body& body = c.scene.body;
    if (!c.scene.pivot || length(*c.scene.pivot) != 0 || !(length(body.center_of_mass) > 0)) return false;
    body.inertia_B = body.inertia_B + parallel_axis(body.mass, body.center_of_mass);
    body.center_of_mass = {};
    return true;
}
// Adds the parallel-axis term to the pivot `times` more times; -1: the term is missing.
inline bool add_parallel_axis(Cause& c, double times) {
    Body& body = c.scene.body;
    const Vector3<double> arm = body.center_of_mass - c.scene.pivot.value_or(body.center_of_mass);
    if (!(length(arm) > 0)) return false;
    body.inertia_B = body.inertia_B + parallel_axis(times * body.mass, arm);
    return true;
}

// Whether the body is free and its origin is not its centre of mass.
inline bool origin_differs(const Scene& scene) { return !scene.pivot && length(scene.body.center_of_mass) > 0; }
inline bool origin_without_centripetal_term(Cause& c, double) {
    c.engine.origin.is_integrated = true, c.engine.origin.has_centripetal = false;
    return origin_differs(c.scene);
}
inline bool origin_without_euler_term(Cause& c, double) {
    c.engine.origin.is_integrated = true, c.engine.origin.has_euler = false;
    return origin_differs(c.scene);
}

inline bool scale_start_rate(Cause& c, double factor) {
    if (!(length(c.scene.initial.angular_velocity) > 0)) return false;
    c.scene.initial.angular_velocity = factor * c.scene.initial.angular_velocity;
    return true;
}
template <Frame written>
bool start_rate_in_other_frame(Cause& c, double) {
    Initial& start = c.scene.initial;
    const Quaternion<double> q = normalized(start.orientation);
    if (start.angular_velocity_frame != written || !(length(start.angular_velocity) > 0) ||
        length(rotate(q, start.angular_velocity) - start.angular_velocity) < 1e-6 * length(start.angular_velocity))
        return false;
    start.angular_velocity_frame = written == Frame::body ? Frame::world : Frame::body;
    return true;
}
inline bool start_inverted(Cause& c, double) {
    Initial& start = c.scene.initial;
    if (length(vector_part(start.orientation)) < 1e-6) return false;
    start.orientation = conjugate(start.orientation);
    return true;
}
inline bool start_scalar_last(Cause& c, double) {
    const Quaternion<double> q = c.scene.initial.orientation;
    c.scene.initial.orientation = {q.z, q.w, q.x, q.y};
    return true;
}
inline bool start_without_orientation(Cause& c, double) {
    if (length(vector_part(c.scene.initial.orientation)) < 1e-6) return false;
    c.scene.initial.orientation = {};
    return true;
}
inline bool start_velocity_factor(Cause& c, double factor) {
    if (c.scene.pivot || !(length(c.scene.initial.velocity_W) > 0)) return false;
    c.scene.initial.velocity_W = factor * c.scene.initial.velocity_W;
    return true;
}

inline bool scale_gravity(Cause& c, double factor) {
    if (!has<Gravity>(c.scene) || (c.scene.pivot && !(length(c.scene.body.center_of_mass - *c.scene.pivot) > 0)))
        return false;
    each<Gravity>(c.scene, [&](Gravity& g) { g.acceleration_W = factor * g.acceleration_W; });
    return true;
}
inline bool gravity_along_y(Cause& c, double) {
    bool along_z = false;
    each<Gravity>(c.scene, [&](Gravity& g) {
        along_z = along_z || g.acceleration_W[2] != 0;
        g.acceleration_W = {g.acceleration_W[0], g.acceleration_W[2], g.acceleration_W[1]};
    });
    return along_z;
}

// Scales torques, forces or impulses.
template <class T>
bool scale_vectors(Cause& c, double factor) {
    each<T>(c.scene, [&](T& load) { load.vector = factor * load.vector; });
    return has<T>(c.scene);
}
template <class T, Frame written>
bool in_other_frame(Cause& c, double) {
    bool any = false;
    each<T>(c.scene, [&](T& load) {
        if (load.frame == written) any = true, load.frame = written == Frame::body ? Frame::world : Frame::body;
    });
    return any;
}
template <class T>
bool at_center(Cause& c, double) {
    bool any = false;
    const Vector3<double> center = c.scene.body.center_of_mass;
    each<T>(c.scene, [&](T& load) {
        if (load.point_frame == Frame::body && length(load.point - center) > 0) any = true, load.point = center;
    });
    return any && !c.scene.pivot;
}
// Measures points in body axes from the centre of mass instead of the origin.
template <class T>
bool from_center(Cause& c, double) {
    bool any = false;
    const Vector3<double> center = c.scene.body.center_of_mass;
    each<T>(c.scene, [&](T& load) {
        if (load.point_frame == Frame::body && length(center) > 0) any = true, load.point = load.point + center;
    });
    return any;
}
// Mirrors points in body axes at the centre of mass or the pivot: the torque has the opposite sign.
template <class T>
bool arm_negated(Cause& c, double) {
    bool any = false;
    const Vector3<double> center = c.scene.pivot.value_or(c.scene.body.center_of_mass);
    each<T>(c.scene, [&](T& load) {
        if (load.point_frame == Frame::body && length(load.point - center) > 0)
            any = true, load.point = 2.0 * center - load.point;
    });
    return any;
}
// Uses a point in body axes as a point fixed in the world, or the reverse.
template <class T, Frame written>
bool point_in_other_frame(Cause& c, double) {
    bool any = false;
    each<T>(c.scene, [&](T& load) {
        if (load.point_frame == written)
            any = true, load.point_frame = written == Frame::body ? Frame::world : Frame::body;
    });
    return any;
}
inline bool arm_in_world(Cause& c, double) {
    c.engine.arm_not_rotated = true;
    const Vector3<double> center = c.scene.pivot.value_or(c.scene.body.center_of_mass);
    return has_load(c.scene, [&](const Load& load) {
        const Force* force = std::get_if<Force>(&load);
        return force && force->point_frame == Frame::body && length(force->point - center) > 0;
    });
}
inline bool drag_in_world(Cause& c, double) {
    c.engine.drag_in_world = true;
    return has_load(c.scene, [](const Load& load) {
        const Drag* drag = std::get_if<Drag>(&load);
        return drag && (drag->rotational[0] != drag->rotational[1] || drag->rotational[1] != drag->rotational[2]);
    });
}
template <TorqueAxes axes>
bool spring_in_other_axes(Cause& c, double) {
    c.engine.spring = axes;
    return has<Spring>(c.scene);
}
// Gravity rotates with the body: a force at the centre of mass, constant in body axes.
inline bool gravity_in_body_axes(Cause& c, double) {
    bool any = false;
    for (Load& load : c.scene.loads)
        if (const Gravity* g = std::get_if<Gravity>(&load)) {
            const Window window = g->window;
            load = Force{c.scene.body.mass * g->acceleration_W, Frame::body, c.scene.body.center_of_mass, Frame::body,
                         window};
            any = true;
        }
    return any;
}
inline bool scale_spring(Cause& c, double factor) {
    each<Spring>(c.scene, [&](Spring& s) { s.stiffness *= factor; });
    return has<Spring>(c.scene);
}
inline bool scale_drag(Cause& c, double factor) {
    each<Drag>(c.scene, [&](Drag& d) { d.rotational = factor * d.rotational, d.translational *= factor; });
    return has<Drag>(c.scene);
}
// Uses c of the torque -c w as a decay rate: dw/dt = -c w.
inline bool drag_on_rate(Cause& c, double) {
    bool any = false;
    each<Drag>(c.scene, [&](Drag& d) {
        if (!(length(d.rotational) > 0)) return;
        any = true, c.engine.axis_damping_B = c.engine.axis_damping_B + d.rotational, d.rotational = {};
    });
    return any;
}
inline bool scale_all_torques(Cause& c, double factor) {
    const bool torque = scale_vectors<Torque>(c, factor), spring = scale_spring(c, factor);
    return torque && spring;
}

// Multiplies all formulas of torques, or all of forces and potentials, by a factor.
template <bool torques>
bool scale_formulas(Cause& c, double factor) {
    bool any = false;
    each<FormulaLoad>(c.scene, [&](FormulaLoad& load) {
        if ((load.kind == FormulaKind::torque) != torques) return;
        any = true, load.formula = fmt::format("({:.17g})*({})", factor, load.formula);
    });
    return any;
}
template <FormulaKind kind, Frame written>
bool formula_in_other_frame(Cause& c, double) {
    bool any = false;
    each<FormulaLoad>(c.scene, [&](FormulaLoad& load) {
        if (load.kind == kind && load.frame == written)
            any = true, load.frame = written == Frame::body ? Frame::world : Frame::body;
    });
    return any;
}
inline bool hold_formulas(Cause& c, double) {
    c.engine.formulas_held = true;
    return has<FormulaLoad>(c.scene);
}

}  // namespace polhode::fault_effects
