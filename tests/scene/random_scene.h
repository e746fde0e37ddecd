// Random valid scenes for RapidCheck.
#pragma once

#include <rapidcheck.h>

#include <cmath>

#include "scene/scene.h"

namespace polhode {

/// Magnitudes from 1e-8 to 1e8 of either sign, sometimes zero, with all mantissa bits random.
inline rc::Gen<double> real_number() {
    return rc::gen::map(rc::gen::tuple(rc::gen::inRange<long>(-(1L << 53), 1L << 53), rc::gen::inRange(-27, 28)),
                        [](const auto& parts) {
                            const auto [mantissa, exponent] = parts;
                            return std::ldexp(static_cast<double>(mantissa), exponent - 53);
                        });
}

inline Vector3<double> random_vector() { return {*real_number(), *real_number(), *real_number()}; }
inline double positive_number() { return std::abs(*real_number()) + 0x1p-20; }
inline Frame random_frame() { return *rc::gen::arbitrary<bool>() ? Frame::body : Frame::world; }

inline Quaternion<double> random_orientation() {
    const Vector3<double> v = random_vector();
    const double w = *real_number(), norm = std::hypot(std::hypot(w, v[0]), std::hypot(v[1], v[2]));
    if (norm == 0) return {};
    return {w / norm, v[0] / norm, v[1] / norm, v[2] / norm};
}

inline Window random_window() {
    Window window;
    if (*rc::gen::arbitrary<bool>()) window.from = *real_number();
    if (*rc::gen::arbitrary<bool>()) {
        const double begin = std::isfinite(window.from) ? window.from : 0;
        window.until = begin + std::abs(begin) * 0.5 + positive_number();
    }
    return window;
}

inline Load random_load() {
    switch (*rc::gen::inRange(0, 6)) {
        case 0:
            return Gravity{random_vector(), random_window()};
        case 1:
            return Torque{random_vector(), random_frame(), random_window()};
        case 2:
            return Force{random_vector(), random_frame(), random_vector(), random_frame(), random_window()};
        case 3:
            return Impulse{random_vector(), random_frame(), random_vector(), random_frame(), std::abs(*real_number())};
        case 4:
            return Drag{random_vector(), *real_number(), random_window()};
        default:
            return Spring{*real_number(), random_orientation(), random_window()};
    }
}

/// A valid body: moments a + b, b + c, c + a with positive a, b, c; in half the cases in rotated axes.
inline Body random_body() {
    Body body;
    body.mass = positive_number();
    const double a = positive_number(), b = positive_number(), c = positive_number();
    body.inertia_B = diagonal(Vector3<double>(a + b, b + c, c + a));
    if (*rc::gen::arbitrary<bool>()) {
        const Matrix3<double> R = rotation_matrix(random_orientation());
        body.inertia_B = R * body.inertia_B * transposed(R);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < i; ++j) body.inertia_B[i][j] = body.inertia_B[j][i];
    }
    body.center_of_mass = random_vector();
    return body;
}

inline Scene random_scene() {
    Scene scene;
    // not a name that a spreadsheet takes for a formula
    scene.name = *rc::gen::suchThat(rc::gen::nonEmpty(rc::gen::string<std::string>()),
                                    [](const std::string& name) { return name.find_first_of("=+-@") != 0; });
    for (char& letter : scene.name)
        if (letter < ' ' || letter > '~') letter = '?';
    scene.about = *rc::gen::container<std::string>(rc::gen::inRange<char>(32, 127));
    scene.duration = positive_number();
    scene.body = random_body();
    scene.initial.orientation = random_orientation();
    scene.initial.angular_velocity = random_vector();
    scene.initial.angular_velocity_frame = random_frame();
    if (*rc::gen::arbitrary<bool>()) {
        scene.pivot = random_vector();
    } else {
        scene.initial.position_W = random_vector();
        scene.initial.velocity_W = random_vector();
    }
    const int loads = *rc::gen::inRange(0, 5);
    for (int i = 0; i < loads; ++i) scene.loads.push_back(random_load());
    if (*rc::gen::arbitrary<bool>()) scene.tolerated["attitude"] = positive_number();
    if (*rc::gen::arbitrary<bool>()) scene.tolerated["momentum"] = positive_number();
    return scene;
}

}  // namespace polhode
