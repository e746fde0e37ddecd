#include "motion/ensemble_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "bad_files.h"
#include "body/fast_principal_frame.h"
#include "motion/translation.h"
#include "motion/written_tables.h"
#include "text/json_document.h"

namespace polhode {
namespace {

Scene scene_in_flight() {
    Scene scene;
    scene.name = "flight", scene.duration = 1;
    scene.body.mass = 3;
    scene.body.inertia_B = {
        {Vector3<double>(1, 0.1, 0.2), Vector3<double>(0.1, 1.2, 0.05), Vector3<double>(0.2, 0.05, 1.4)}};
    scene.initial.orientation = {0.6, 0.8, 0, 0};
    scene.initial.angular_velocity = {1, 2, 3};
    scene.initial.position_W = {4, 5, 6};
    scene.initial.velocity_W = {7, 8, 9};
    return scene;
}

std::string message_of(const std::string& text, const Scene& scene = scene_in_flight()) {
    try {
        parse_ensemble(text, "table.csv", scene);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

TEST(EnsembleTable, ColumnsByNameInAnyOrder) {
    const EnsembleTable table =
        parse_ensemble("wz,wx,wy,qx,qw,qz,qy\n# a comment\n 3 ,1,2,0.5,0.5,-0.5,0.5\r\n-3e-1,+1,2.5,0,1,0,0\n\n",
                       "t.csv", scene_in_flight());
    ASSERT_EQ(table.bodies.size(), 2u);
    EXPECT_TRUE(table.ids.empty());
    EXPECT_EQ(table.bodies[0].angular_velocity, Vector3<double>(1, 2, 3));
    EXPECT_EQ(table.bodies[0].orientation, (Quaternion<double>{0.5, 0.5, 0.5, -0.5}));
    EXPECT_EQ(table.bodies[1].angular_velocity, Vector3<double>(1, 2.5, -0.3));
}

TEST(EnsembleTable, WhatIsMissingIsTheScenes) {
    const Scene scene = scene_in_flight();
    const EnsembleTable table = parse_ensemble("mass\n2\n", "t.csv", scene);
    EnsembleBody expected = ensemble_body(scene);
    expected.mass = 2;
    ASSERT_EQ(table.bodies.size(), 1u);
    EXPECT_EQ(table.bodies[0], expected);
}

TEST(EnsembleTable, MomentsWithoutProductsAreThoseOfTheBodyAxes) {
    const EnsembleTable table = parse_ensemble("ixx,iyy,izz\n1,2,2.5\n", "t.csv", scene_in_flight());
    EXPECT_EQ(table.bodies[0].inertia_B, diagonal(Vector3<double>(1, 2, 2.5)));
    const EnsembleTable tensor =
        parse_ensemble("iyz,ixx,ixz,iyy,ixy,izz\n0.1,1,-0.2,2,0.3,2.5\n", "t.csv", scene_in_flight());
    EXPECT_EQ(tensor.bodies[0].inertia_B, (Matrix3<double>{{Vector3<double>(1, 0.3, -0.2), Vector3<double>(0.3, 2, 0.1),
                                                            Vector3<double>(-0.2, 0.1, 2.5)}}));
}

TEST(EnsembleTable, KeepsIds) {
    const EnsembleTable table = parse_ensemble("mass,id\n1,a b\n2,\n3,\xc3\xa9\n", "t.csv", scene_in_flight());
    EXPECT_EQ(table.ids, (std::vector<std::string>{"a b", "", "\xc3\xa9"}));
}

TEST(EnsembleTable, ReadsBack) {
    Scene scene = scene_in_flight();
    EnsembleTable table = parse_ensemble("id,mass,wx,wy,wz\nx,0.1,1e-300,-0.0,1e22\ny,2,1,2,3\n", "t.csv", scene);
    const EnsembleTable again = parse_ensemble(write_ensemble(table, false), "w.csv", scene);
    EXPECT_EQ(again.bodies, table.bodies);
    EXPECT_EQ(again.ids, table.ids);
}

TEST(EnsembleTable, NoPositionBesideAPivot) {
    Scene scene = scene_in_flight();
    scene.pivot = Vector3<double>(0, 0, 1);
    scene.initial.position_W = scene.initial.velocity_W = {};
    for (const char* header : {"px,py,pz\n", "vx,vy,vz\n"}) {
        const std::string message = message_of(std::string(header) + "0,0,0\n", scene);
        EXPECT_NE(message.find("table.csv: line 1: "), std::string::npos) << message;
        EXPECT_NE(message.find("pivot"), std::string::npos) << message;
    }
    EXPECT_EQ(message_of("mass\n1\n", scene), "");
}

TEST(EnsembleTable, SaysWhatWasMeant) { EXPECT_NE(message_of("wx,wy,wz,iyx\n").find("ixy"), std::string::npos); }

class BadEnsemble : public ::testing::TestWithParam<BadFile> {};

TEST_P(BadEnsemble, IsRefusedInOneLine) {
    std::string message;
    try {
        parse_ensemble(read_text(GetParam().path), GetParam().path, scene_in_flight());
    } catch (const InputError& error) {
        message = error.what();
    }
    expect_one_line(GetParam(), message);
}

INSTANTIATE_TEST_SUITE_P(Files, BadEnsemble, ::testing::ValuesIn(bad_files("motion/ensemble", ".csv")));

TEST(EnsembleTable, CatalogueOfBadFilesIsWhole) { expect_whole_catalogue("motion/ensemble", ".csv"); }

// The fast validity check never accepts a body that the full rules refuse. With a pivot, a body at the origin is
// always checked by the full rules, so the two results can be compared.
TEST(EnsembleTable, WhatIsSoundAtAGlanceIsSoundByTheRules) {
    std::mt19937_64 random(3);
    const std::vector<double> edges{0,     -0.0,  1,      1 + 1e-13, 1 + 1e-11, 2,   2 + 1e-11, -1,   1e-310,
                                    1e300, 1e308, 1e-300, INFINITY,  NAN,       0.5, 1e-7,      3e-7, 1 - 1e-13};
    const auto any = [&] { return edges[random() % edges.size()]; };
    int sound = 0, refused = 0;
    for (int i = 0; i < 200'000; ++i) {
        EnsembleBody b = ensemble_body(scene_in_flight());
        b.position_W = b.velocity_W = {};
        b.inertia_B = {{Vector3<double>(1, 0, 0), Vector3<double>(0, 1.5, 0), Vector3<double>(0, 0, 2)}};
        // replace one to three numbers
        for (std::size_t changes = 1 + random() % 3; changes > 0; --changes) {
            double* const numbers[] = {
                &b.mass,          &b.inertia_B[0][0], &b.inertia_B[1][1],    &b.inertia_B[2][2], &b.inertia_B[0][1],
                &b.orientation.w, &b.orientation.z,   &b.angular_velocity[1]};
            *numbers[random() % std::size(numbers)] = any();
        }
        const bool glance = !fault_of(b, false), rules = !fault_of(b, true);
        ASSERT_EQ(glance, rules) << b.mass << " " << b.inertia_B[0][0] << " " << b.inertia_B[1][1] << " "
                                 << b.inertia_B[2][2] << " " << b.inertia_B[0][1] << " " << b.orientation.w;
        (rules ? sound : refused)++;
    }
    EXPECT_GT(sound, 10'000);
    EXPECT_GT(refused, 10'000);
}

TEST(FastPrincipalFrame, StandsForTheTensor) {
    std::mt19937_64 engine(1);
    const auto uniform = [&] { return static_cast<double>(engine() >> 11) * 0x1p-53; };
    for (int n = 0; n < 200; ++n) {
        const double spread = std::pow(10, -6 * uniform());
        const Vector3<double> I(1, 0.5 + 0.5 * uniform(), n % 5 == 0 ? 1 : spread);
        Quaternion<double> q{uniform() + 0.1, uniform(), uniform(), uniform()};
        const double size = std::sqrt(squared_norm(q));
        q = {q.w / size, q.x / size, q.y / size, q.z / size};
        const Matrix3<double> R = rotation_matrix(q);
        Matrix3<double> J = R * diagonal(I) * transposed(R);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < i; ++j) J[i][j] = J[j][i];
        const PrincipalFrame frame = fast_principal_frame(J);
        const Matrix3<double> axes = rotation_matrix(frame.q_BP);
        const Matrix3<double> back = axes * diagonal(frame.moments) * transposed(axes);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) EXPECT_NEAR(back[i][j], J[i][j], 4e-15);
        Vector3<double> wide = principal_frame(cast<Wide>(J)).moments, fast = frame.moments;
        std::sort(wide.component.begin(), wide.component.end());
        std::sort(fast.component.begin(), fast.component.end());
        for (int i = 0; i < 3; ++i) EXPECT_NEAR(fast[i], wide[i], 2e-15);
    }
    const Vector3<double> I(3, 1, 2);
    EXPECT_EQ(fast_principal_frame(diagonal(I)).q_BP, Quaternion<double>{});
    EXPECT_EQ(fast_principal_frame(diagonal(I)).moments, I);
}

TEST(Translation, KeepsTheEquationOfMotion) {
    // compare with the midpoint rule for dv/dt = a - k v at small steps, extrapolated
    const Vector3<double> a(0.3, -9.8, 0.1), p0(1, 2, 3), v0(-4, 5, 0.5);
    for (const double k : {0.0, 1e-9, 0.3, 4.0, -0.5}) {
        const double t = 1.5;
        Vector3<double> p = p0, v = v0;
        translate(a, k, t, p, v);
        const auto by_steps = [&](int n) {
            Vector3<double> x = p0, u = v0;
            const double h = t / n;
            for (int i = 0; i < n; ++i) {
                const Vector3<double> middle = u + (h / 2) * (a - k * u);
                x = x + h * middle, u = u + h * (a - k * middle);
            }
            return std::pair(x, u);
        };
        const auto [coarse_p, coarse_v] = by_steps(2000);
        const auto [fine_p, fine_v] = by_steps(4000);
        for (int i = 0; i < 3; ++i) {
            EXPECT_NEAR(p[i], (4 * fine_p[i] - coarse_p[i]) / 3, 1e-8) << k;
            EXPECT_NEAR(v[i], (4 * fine_v[i] - coarse_v[i]) / 3, 1e-8) << k;
        }
    }
}

}  // namespace
}  // namespace polhode
