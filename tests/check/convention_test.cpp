#include "check/convention.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <numbers>

#include "scene/random_scene.h"

namespace polhode {
namespace {

constexpr Axes all_axes[] = {Axes::z_up_right, Axes::y_up_right, Axes::z_up_left, Axes::y_up_left};

// M as a matrix, written independently from the documentation of Axes.
Matrix3<double> matrix_of(Axes axes) {
    switch (axes) {
        case Axes::y_up_right:
            return {{Vector3<double>{1, 0, 0}, {0, 0, -1}, {0, 1, 0}}};
        case Axes::z_up_left:
            return {{Vector3<double>{1, 0, 0}, {0, -1, 0}, {0, 0, 1}}};
        case Axes::y_up_left:
            return {{Vector3<double>{1, 0, 0}, {0, 0, 1}, {0, 1, 0}}};
        default:
            return diagonal(Vector3<double>(1, 1, 1));
    }
}

double determinant(const Matrix3<double>& m) { return dot(m[0], cross(m[1], m[2])); }

double distance(const Matrix3<double>& a, const Matrix3<double>& b) {
    double largest = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) largest = std::max(largest, std::abs(a[i][j] - b[i][j]));
    return largest;
}

TEST(Convention, ConvertsUpAndHandedness) {
    for (const Axes axes : all_axes) {
        const bool y_up = axes == Axes::y_up_right || axes == Axes::y_up_left;
        const bool left = axes == Axes::z_up_left || axes == Axes::y_up_left;
        EXPECT_EQ(vector_from(axes, y_up ? Vector3<double>{0, 1, 0} : Vector3<double>{0, 0, 1}),
                  (Vector3<double>{0, 0, 1}));
        EXPECT_EQ(determinant(matrix_of(axes)), left ? -1 : 1);
    }
}

RC_GTEST_PROP(Convention, AgreesWithMatrices, ()) {
    const Axes axes = *rc::gen::element(all_axes[0], all_axes[1], all_axes[2], all_axes[3]);
    const Matrix3<double> M = matrix_of(axes);
    const Vector3<double> v = random_vector(), w = random_vector();
    RC_ASSERT(vector_from(axes, v) == M * v);
    // a reflection reverses the sign of cross products, and so of angular velocities
    const Vector3<double> product = cross(M * v, M * w), expected = pseudovector_from(axes, cross(v, w));
    const double size = std::sqrt(dot(v, v) * dot(w, w));
    for (int i = 0; i < 3; ++i) RC_ASSERT(std::abs(product[i] - expected[i]) <= 1e-15 * size);
    // an attitude there, R, is M R M^T here
    const Quaternion<double> q = random_orientation();
    RC_ASSERT(distance(rotation_matrix(quaternion_from(axes, q)), M * rotation_matrix(q) * transposed(M)) < 1e-14);
}

RC_GTEST_PROP(Convention, RoundTripIsTheIdentity, ()) {
    const Axes axes = *rc::gen::element(all_axes[0], all_axes[1], all_axes[2], all_axes[3]);
    const Vector3<double> v = random_vector();
    const Quaternion<double> q = random_orientation();
    RC_ASSERT(vector_to(axes, vector_from(axes, v)) == v);
    RC_ASSERT(vector_from(axes, vector_to(axes, v)) == v);
    RC_ASSERT(pseudovector_to(axes, pseudovector_from(axes, v)) == v);
    RC_ASSERT(quaternion_to(axes, quaternion_from(axes, q)) == q);
}

// The equation dq/dt = 1/2 (0, w) q holds in both axes: rates and attitudes are converted consistently.
RC_GTEST_PROP(Convention, KinematicsSurvive, ()) {
    const Axes axes = *rc::gen::element(all_axes[0], all_axes[1], all_axes[2], all_axes[3]);
    const Vector3<double> w = random_vector();
    const Quaternion<double> q = random_orientation(), rate = Quaternion<double>{0, w[0], w[1], w[2]} * q;
    const Vector3<double> w_here = pseudovector_from(axes, w);
    const Quaternion<double> here = Quaternion<double>{0, w_here[0], w_here[1], w_here[2]} * quaternion_from(axes, q);
    const Quaternion<double> expected = quaternion_from(axes, rate);
    const double size = std::sqrt(dot(w, w));
    for (const double d : {here.w - expected.w, here.x - expected.x, here.y - expected.y, here.z - expected.z})
        RC_ASSERT(std::abs(d) <= 1e-14 * size);
}

TEST(Convention, WordsAreReadAndWritten) {
    EXPECT_EQ(parse_convention("z-up,right-handed,radians"), Convention{});
    EXPECT_EQ(name_of(Convention{}), "");
    for (const char* words : {"y-up", "left-handed", "y-up,left-handed", "y-up,left-handed,scalar-last,degrees",
                              "scalar-first", "degrees", "y-up,body-rates,inches", "centimetres"})
        EXPECT_EQ(name_of(parse_convention(words)), words);
    EXPECT_EQ(parse_convention("unity"), parse_convention("left-handed,y-up"));
    EXPECT_EQ(parse_convention("godot,degrees"), parse_convention("degrees,y-up"));
    EXPECT_EQ(parse_convention("three"), parse_convention("bullet"));
    EXPECT_EQ(parse_convention("unreal"), parse_convention("left-handed,centimetres"));
    for (const char* words : {"", "y-up,", "y-up,z-up", "unity,right-handed", "unreal,metres", "body-rates,world-rates",
                              "cm", "x-up", "scalar-last,scalar-first", "Y-UP", "y-up, degrees"})
        EXPECT_THROW(parse_convention(words), std::invalid_argument) << words;
    try {
        parse_convention("y-upp");
        FAIL();
    } catch (const std::invalid_argument& error) {
        EXPECT_NE(std::string(error.what()).find("did you mean y-up?"), std::string::npos) << error.what();
    }
}

TEST(Convention, ScalarLastUsesTheFileOrder) {
    const Quaternion<double> expected{4, 1, 2, 3};
    const auto read = [](const char* header, QuaternionColumns columns) {
        return parse_trajectory(std::string(header) + "\n0,1,2,3,4\n", "f", columns).rows[0].q;
    };
    // columns named w, x, y, z that hold x, y, z, w; and correct names
    EXPECT_EQ(read("t,qw,qx,qy,qz", QuaternionColumns::scalar_last), expected);
    EXPECT_EQ(read("t,qx,qy,qz,qw", QuaternionColumns::scalar_last), expected);
    EXPECT_EQ(read("t,qx,qy,qz,qw", QuaternionColumns::by_name), expected);
    EXPECT_EQ(read("t,qx,qy,qz,qw", QuaternionColumns::scalar_first), (Quaternion<double>{1, 2, 3, 4}));
}

TEST(Convention, UnitsOfLengthAndRatesInBodyAxes) {
    // a rotation by 90 degrees about z: the body's x axis is the world's y axis
    TrajectoryFile file =
        parse_trajectory("t,qw,qx,qy,qz,wx,wy,wz,px,py,pz,vx,vy,vz\n0,1,0,0,1,3,0,0,100,200,300,400,5,6\n", "f");
    convert(file, parse_convention("body-rates,centimetres"));
    const TrajectoryRow& row = file.rows[0];
    EXPECT_NEAR(row.angular_velocity_W[0], 0, 1e-15);
    EXPECT_NEAR(row.angular_velocity_W[1], 3, 1e-15);
    EXPECT_EQ(row.position_W, (Vector3<double>{1, 2, 3}));
    EXPECT_EQ(row.velocity_W[0], 4);
}

TEST(Convention, ConvertsAFile) {
    TrajectoryFile file =
        parse_trajectory("t,qw,qx,qy,qz,wx,wy,wz,px,py,pz,vx,vy,vz\n0,0.5,0.1,0.2,0.3,180,90,0,1,2,3,4,5,6\n", "f");
    convert(file, parse_convention("unity,degrees"));
    const TrajectoryRow& row = file.rows[0];
    EXPECT_EQ(row.q, (Quaternion<double>{0.5, -0.1, -0.3, -0.2}));
    EXPECT_NEAR(row.angular_velocity_W[0], -std::numbers::pi, 1e-15);
    EXPECT_NEAR(row.angular_velocity_W[2], -std::numbers::pi / 2, 1e-15);
    EXPECT_EQ(row.position_W, (Vector3<double>{1, 3, 2}));
    EXPECT_EQ(row.velocity_W, (Vector3<double>{4, 6, 5}));
}

}  // namespace
}  // namespace polhode
