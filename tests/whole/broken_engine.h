// A small engine with selectable faults: explicit steps in world axes, in binary64 or binary32.
#pragma once

#include <cmath>
#include <limits>
#include <type_traits>
#include <vector>

#include "motion/exact_body.h"
#include "motion/problem.h"
#include "motion/trajectory_csv.h"

namespace polhode {

struct Broken {
    double gyroscopic = 1;  ///< factor on the gyroscopic term
    double damping = 0;     ///< 1/s, w *= 1 - c h each step
    double speed_limit = std::numeric_limits<double>::infinity();
    bool first_order = false;  ///< q += (h/2) w q, normalised
    double step_factor = 1;    ///< the engine's step is this factor times the step of its clock
};

/// Steps the scene (gravity about a pivot, torques, rotational drag; no translation) by `step` and records a row
/// every `every` steps. A second-order Runge-Kutta step for w keeps the truncation error below the fault's effect.
template <class Real>
TrajectoryFile engine_run(const Scene& scene, const Broken& broken, double step, int every) {
    using V = Vector3<Real>;
    using Q = Quaternion<Real>;
    const ExactBody<double> body = exact_body<double>(scene);
    const Matrix3<Real> I = cast<Real>(body.inertia_B), inverse_I = cast<Real>(inverse(body.inertia_B));
    Q q = cast<Real>(body.q);
    V w = rotate(q, cast<Real>(body.angular_velocity_B));
    const V arm = cast<Real>(body.arm);
    TrajectoryFile file;
    file.has_angular_velocity = true;
    const Real h = static_cast<Real>(step * broken.step_factor);
    const auto turn = [&](const V& rate, Real dt) {
        const V half = (dt / 2) * rate;
        const Real angle = std::sqrt(dot(half, half));
        const Real s = angle > 0 ? std::sin(angle) / angle : Real(1);
        const Q first{Real(1), half[0], half[1], half[2]},
            exact{std::cos(angle), s * half[0], s * half[1], s * half[2]};
        const Q r = (broken.first_order ? first : exact) * q;
        const Real norm = std::sqrt(squared_norm(r));
        return Q{r.w / norm, r.x / norm, r.y / norm, r.z / norm};
    };
    // dw/dt in world axes at this attitude
    const auto rate_of_change = [&](const Q& at, const V& w_W) {
        const V w_B = rotate_back(at, w_W), L_B = I * w_B;
        V torque = Real(-broken.gyroscopic) * cross(w_B, L_B);
        for (const Load& load : scene.loads) {
            if (const auto* g = std::get_if<Gravity>(&load))
                torque = torque + cross(arm, rotate_back(at, Real(body.mass) * cast<Real>(g->acceleration_W)));
            if (const auto* t = std::get_if<Torque>(&load))
                torque =
                    torque + (t->frame == Frame::body ? cast<Real>(t->vector) : rotate_back(at, cast<Real>(t->vector)));
            if (const auto* d = std::get_if<Drag>(&load))
                for (int i = 0; i < 3; ++i) torque[i] -= Real(d->rotational[i]) * w_B[i];
        }
        return rotate(at, inverse_I * torque);
    };
    const auto count = static_cast<long>(std::floor(scene.duration / step + 1e-9));
    for (long k = 0; k <= count; ++k) {
        if (k % every == 0) {
            TrajectoryRow row;
            row.t = static_cast<double>(static_cast<Real>(static_cast<double>(k) * step));
            row.q = cast<double>(q), row.angular_velocity_W = cast<double>(w);
            file.rows.push_back(row);
        }
        const V first = rate_of_change(q, w), middle_w = w + (h / 2) * first;
        const Q middle_q = turn(w, h / 2);
        const V next = w + h * rate_of_change(middle_q, middle_w);
        q = turn(broken.first_order ? next : middle_w, h);
        w = Real(1 - broken.damping * static_cast<double>(h)) * next;
        const Real speed = std::sqrt(dot(w, w));
        if (speed > static_cast<Real>(broken.speed_limit)) w = (static_cast<Real>(broken.speed_limit) / speed) * w;
    }
    return file;
}

}  // namespace polhode
