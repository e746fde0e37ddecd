// Random scenes with numbers of order one, so that a wrong term differs clearly from round-off.
#pragma once

#include <rapidcheck.h>

#include <array>
#include <cmath>

#include "motion/problem.h"

namespace polhode::testing {

inline double moderate(double low, double high) {
    return low + (high - low) * static_cast<double>(*rc::gen::inRange(0, 100001)) / 1e5;
}
inline Vector3<double> moderate_vector() { return {moderate(-2, 2), moderate(-2, 2), moderate(-2, 2)}; }
inline Frame any_frame() { return *rc::gen::arbitrary<bool>() ? Frame::body : Frame::world; }

/// A unit quaternion, up to rounding.
inline Quaternion<double> moderate_orientation() {
    const Quaternion<double> q{moderate(0.1, 1), moderate(-1, 1), moderate(-1, 1), moderate(-1, 1)};
    return normalized(q);
}

/// A window; one third of them exclude t = 0.
inline Window moderate_window() {
    switch (*rc::gen::inRange(0, 3)) {
        case 0:
            return {};
        case 1:
            return {-1, 0.5};
        default:
            return {0.5, 0.75};
    }
}

inline Load moderate_load() {
    switch (*rc::gen::inRange(0, 5)) {
        case 0:
            return Gravity{moderate_vector(), moderate_window()};
        case 1:
            return Torque{moderate_vector(), any_frame(), moderate_window()};
        case 2:
            return Force{moderate_vector(), any_frame(), moderate_vector(), any_frame(), moderate_window()};
        case 3:
            return Drag{moderate_vector(), moderate(0, 1), moderate_window()};
        default:
            return Spring{moderate(0, 3), moderate_orientation(), moderate_window()};
    }
}

/// A valid tensor about the centre of mass with moments between 0.2 and 4; in half the cases in rotated axes.
inline Matrix3<double> moderate_inertia() {
    const double a = moderate(0.1, 2), b = moderate(0.1, 2), c = moderate(0.1, 2);
    Matrix3<double> inertia = diagonal(Vector3<double>(a + b, b + c, c + a));
    if (*rc::gen::arbitrary<bool>()) {
        const Matrix3<double> R = rotation_matrix(moderate_orientation());
        inertia = R * inertia * transposed(R);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < i; ++j) inertia[i][j] = inertia[j][i];
    }
    return inertia;
}

/// A scene without impulses; one in three has a pivot.
inline Scene moderate_scene() {
    Scene scene;
    scene.name = "random", scene.duration = 1;
    scene.body.mass = moderate(0.2, 3);
    scene.body.inertia_B = moderate_inertia();
    scene.body.center_of_mass = moderate_vector();
    scene.initial.orientation = moderate_orientation();
    scene.initial.angular_velocity = moderate_vector();
    scene.initial.angular_velocity_frame = any_frame();
    if (*rc::gen::inRange(0, 3) == 0) {
        scene.pivot = moderate_vector();
    } else {
        scene.initial.position_W = moderate_vector();
        scene.initial.velocity_W = moderate_vector();
    }
    const int count = *rc::gen::inRange(0, 6);
    for (int i = 0; i < count; ++i) scene.loads.push_back(moderate_load());
    return scene;
}

/// A random state as a sample, w in body axes; with a pivot, p and v follow from q and w.
inline Sample moderate_state(const Problem& problem) {
    Sample s;
    s.q = moderate_orientation();
    s.angular_velocity_B = moderate_vector();
    s.position_W = moderate_vector(), s.velocity_W = moderate_vector();
    if (problem.body.pivoted) pivoted_center(s.q, s.angular_velocity_B, problem.body.arm, s.position_W, s.velocity_W);
    return s;
}

/// The rates of a sample's blocks: w and q = q_WB in body axes.
struct Rates {
    Vector3<double> angular_velocity_B, position_W, velocity_W;
    Quaternion<double> q;
};

/// Rates at t = 0 from the system of this compile-time type, in the problem's first segment, transformed to body
/// axes. Blocks that the system lacks stay zero.
template <class SystemType>
Rates rates_by(const Problem& problem, const Sample& s) {
    constexpr int n = SystemType::dimension;
    static_assert(n == 7 || n == 13);
    const Segment& segment = problem.segments.front();
    std::array<double, n> y{}, f{};
    put(y.data(), 0, rotate_back(problem.body.q_BP, s.angular_velocity_B));
    put(y.data(), 3, s.q * problem.body.q_BP);
    if constexpr (n == 13) put(y.data(), 7, s.position_W), put(y.data(), 10, s.velocity_W);
    SystemType(problem, segment).derivative(0, y.data(), f.data());
    Rates rates;
    rates.angular_velocity_B = rotate(problem.body.q_BP, vector_at(f.data(), 0));
    rates.q = quaternion_at(f.data(), 3) * conjugate(problem.body.q_BP);
    if constexpr (n == 13) rates.position_W = vector_at(f.data(), 7), rates.velocity_W = vector_at(f.data(), 10);
    return rates;
}

inline double distance(const Vector3<double>& a, const Vector3<double>& b) { return std::sqrt(dot(a - b, a - b)); }
inline double length(const Vector3<double>& a) { return std::sqrt(dot(a, a)); }
inline double largest_difference(const Matrix3<double>& a, const Matrix3<double>& b) {
    double largest = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) largest = std::max(largest, std::abs(a[i][j] - b[i][j]));
    return largest;
}

}  // namespace polhode::testing
