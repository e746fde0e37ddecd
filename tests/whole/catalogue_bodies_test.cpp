// The mass properties stated in comments of the built-in scenes, derived independently: from the matrix of second
// moments C = int r r^T dm about the centre of mass, I = tr(C) 1 - C. Without parallel axes, without tabulated moments.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "scene/scene_file.h"

namespace polhode {
namespace {

// A part of mass m: C = m diag(s) about its own centre, where s are the mean squares of x, y and z.
struct Part {
    double mass;
    Vector3<double> mean_squares, center;
};
Vector3<double> box(double a, double b, double c) { return {a * a / 3, b * b / 3, c * c / 3}; }  // half sides
Vector3<double> ball(double r) { return {r * r / 5, r * r / 5, r * r / 5}; }
// mean squares for axis k, radius r, length L; a disc for L = 0
Vector3<double> cylinder(int k, double r, double L) {
    Vector3<double> s(r * r / 4, r * r / 4, r * r / 4);
    s[k] = L * L / 12;
    return s;
}

struct Expected {
    double mass = 0;
    Vector3<double> center;
    Matrix3<double> inertia;
};
Expected assembled(const std::vector<Part>& parts) {
    Expected body;
    for (const Part& part : parts) {
        body.mass += part.mass;
        body.center = body.center + part.mass * part.center;
    }
    body.center = (1 / body.mass) * body.center;
    Matrix3<double> C;
    for (const Part& part : parts) {
        const Vector3<double> d = part.center - body.center;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) C[i][j] += part.mass * (d[i] * d[j] + (i == j ? part.mean_squares[i] : 0));
    }
    const double trace = C[0][0] + C[1][1] + C[2][2];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) body.inertia[i][j] = (i == j ? trace : 0) - C[i][j];
    return body;
}

void expect_body(const char* name, const std::vector<Part>& parts) {
    SCOPED_TRACE(name);
    const Body& body = find_scene(name).body;
    const Expected expected = assembled(parts);
    // a few roundings of the sums above and one of the value in the file
    const double largest = expected.inertia[0][0] + expected.inertia[1][1] + expected.inertia[2][2];
    EXPECT_NEAR(body.mass, expected.mass, 4e-16 * expected.mass);
    for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(body.center_of_mass[i], expected.center[i], 1e-16);
        for (int j = 0; j < 3; ++j)
            EXPECT_NEAR(body.inertia_B[i][j], expected.inertia[i][j], 1e-15 * largest) << i << j;
    }
}

TEST(CatalogueBodies, HaveTheStatedShapes) {
    expect_body("t_handle", {{0.3, cylinder(0, 0.01, 0.12), {}}, {0.15, cylinder(1, 0.01, 0.06), {0, 0.04, 0}}});
    expect_body("t_handle_parts", {{0.3, cylinder(0, 0.01, 0.12), {}}, {0.15, cylinder(1, 0.01, 0.06), {0, 0.04, 0}}});
    expect_body("thrown_hammer",
                {{0.4, cylinder(2, 0.012, 0.36), {0, 0, 0.18}}, {0.6, box(0.06, 0.015, 0.015), {0, 0, 0.375}}});
    expect_body("box_with_sphere", {{1, box(0.3, 0.2, 0.1), {}}, {0.5, ball(0.1), {0.2, 0.1, 0.2}}});
    expect_body("feynman_plate", {{0.2, cylinder(2, 0.125, 0), {}}});
    expect_body("explorer_1", {{13.97, cylinder(2, 0.076, 2.051), {}}});
    expect_body("sphere", {{1, ball(0.5), {}}});
    expect_body("mujoco_box", {{1, box(0.1, 0.2, 0.3), {}}});
    expect_body("gazebo_box", {{10, box(0.05, 0.2, 0.45), {}}});
    expect_body("struck_bar", {{2, box(0.5, 0.05, 0.025), {}}});
    expect_body("compound_pendulum", {{1, box(0.02, 0.01, 0.5), {0, 0, -0.5}}});
    const double silica = 4 * std::numbers::pi / 3 * std::pow(85e-9, 3) * 2000;
    expect_body("nanodumbbell", {{silica, ball(85e-9), {85e-9, 0, 0}}, {silica, ball(85e-9), {-85e-9, 0, 0}}});
    const double steel = 4 * std::numbers::pi / 3 * std::pow(2.5e-3, 3) * 7800;
    expect_body("stokes_sphere", {{steel, ball(2.5e-3), {}}});
}

TEST(CatalogueBodies, OfGravityProbeBIsABallToAPartInAMillion) {
    const Body& body = find_scene("gravity_probe_b").body;
    const double ball = 0.4 * body.mass * 0.0191 * 0.0191;
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(body.inertia_B[i][i] / ball, 1 + (i - 1) * 1e-6, 1e-12);
}

TEST(CatalogueBodies, OfToutatisHasThePublishedRatios) {
    const Matrix3<double>& I = find_scene("toutatis").body.inertia_B;
    EXPECT_NEAR(I[0][0] / I[2][2], 3.22, 1e-15);
    EXPECT_NEAR(I[1][1] / I[2][2], 3.09, 1e-15);
}

}  // namespace
}  // namespace polhode
