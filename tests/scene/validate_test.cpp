// Errors that a scene made in C++ can have but a file cannot: the same rules and the same places in messages.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "body/rigid_body.h"
#include "scene/random_scene.h"
#include "scene/scene.h"

namespace polhode {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();

std::string fault_with(const std::function<void(Scene&)>& change) {
    Scene s;
    s.name = "made", s.duration = 1;
    change(s);
    try {
        validate(s, "made.cpp");
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

TEST(Validate, ABodyOfAMechanismMayHaveNoMassOrAMomentOfZero) {
    const auto fault_of = [](double mass, const Matrix3<double>& inertia) {
        return fault_with([&](Scene& s) {
            s.bodies.push_back({"arm", {}, {}});
            s.bodies[0].body.mass = mass, s.bodies[0].body.inertia_B = inertia;
            Joint hinge;
            hinge.name = "hinge", hinge.parent = "world", hinge.child = "arm", hinge.axes[0] = {0, 1, 0};
            s.joints = {hinge};
        });
    };
    using V3 = Vector3<double>;
    Matrix3<double> tilted_rod = parallel_axis(2.0, V3(0.3, -0.4, 0.7));
    EXPECT_EQ(fault_of(0, {}), "");
    EXPECT_EQ(fault_of(1, {}), "");
    EXPECT_EQ(fault_of(1, diagonal(V3(0.5, 0.5, 0))), "");
    EXPECT_EQ(fault_of(1, tilted_rod), "");
    EXPECT_NE(fault_of(-1, {}).find("/bodies/0/body/mass: is -1; the mass must be >= 0"), std::string::npos);
    EXPECT_NE(fault_of(0, diagonal(V3(1, 1, 1))).find("/bodies/0/body/inertia: is not zero, but the mass is 0"),
              std::string::npos);
    EXPECT_NE(fault_of(1, diagonal(V3(1, 1, -0.5))).find("/bodies/0/body/inertia/2: is -0.5"), std::string::npos);
    EXPECT_NE(fault_of(1, diagonal(V3(1, 0, 0))).find("triangle inequality"), std::string::npos);
    tilted_rod[0][0] -= 1, tilted_rod[1][1] -= 1;
    EXPECT_NE(fault_of(1, tilted_rod).find("must be >= 0"), std::string::npos);
    // a scene of one body needs mass and moments
    EXPECT_NE(fault_with([](Scene& s) { s.body.mass = 0; }).find("/body/mass: is 0; the mass must be > 0"),
              std::string::npos);
    EXPECT_NE(fault_with([](Scene& s) { s.body.inertia_B = {}; }).find("must be > 0"), std::string::npos);
}

TEST(Validate, NamesThePlaceOfWhateverIsNotFinite) {
    const std::pair<const char*, std::function<void(Scene&)>> faults[] = {
        {"/duration: is nan", [](Scene& s) { s.duration = nan; }},
        {"/body/mass: is inf", [](Scene& s) { s.body.mass = infinity; }},
        {"/body/center_of_mass/2: is nan", [](Scene& s) { s.body.center_of_mass[2] = nan; }},
        {"/body/inertia/0/1: is nan", [](Scene& s) { s.body.inertia_B[0][1] = nan; }},
        {"/initial/orientation/0: is nan", [](Scene& s) { s.initial.orientation.w = nan; }},
        {"/initial/position/1: is -inf", [](Scene& s) { s.initial.position_W[1] = -infinity; }},
        {"/initial/velocity/1: is nan", [](Scene& s) { s.initial.velocity_W[1] = nan; }},
        {"/pivot/0: is nan", [](Scene& s) { s.pivot = Vector3<double>(nan, 0, 0); }},
        {"/loads/0/acceleration/2: is nan",
         [](Scene& s) {
             s.loads = {Gravity{{0, 0, nan}, {}}};
         }},
        {"/loads/1/vector/0: is nan",
         [](Scene& s) {
             s.loads = {Gravity{}, Torque{{nan, 0, 0}, Frame::body, {}}};
         }},
        {"/loads/0/point/0: is inf",
         [](Scene& s) {
             s.loads = {Force{{}, Frame::body, {infinity, 0, 0}, Frame::body, {}}};
         }},
        {"/loads/0/at: is nan",
         [](Scene& s) {
             s.loads = {Impulse{{}, Frame::body, {}, Frame::body, nan}};
         }},
        {"/loads/0/translational: is nan",
         [](Scene& s) {
             s.loads = {Drag{{}, nan, {}}};
         }},
        {"/loads/0/stiffness: is nan",
         [](Scene& s) {
             s.loads = {Spring{nan, {}, {}}};
         }},
        {"/loads/0/from: is nan",
         [](Scene& s) {
             s.loads = {Gravity{{}, {nan, 1}}};
         }},
        {"/loads/0/until: is nan",
         [](Scene& s) {
             s.loads = {Gravity{{}, {0, nan}}};
         }},
        {"/loads/0/from: is inf",
         [](Scene& s) {
             s.loads = {Gravity{{}, {infinity, infinity}}};
         }},
        {"/tolerated/attitude: is nan", [](Scene& s) { s.tolerated["attitude"] = nan; }},
    };
    for (const auto& [place, change] : faults) {
        const std::string message = fault_with(change);
        EXPECT_EQ(message.find(std::string("made.cpp: ") + place), 0u) << place << "\n" << message;
    }
}

TEST(Validate, RefusesWhatCannotBe) {
    EXPECT_NE(fault_with([](Scene& s) { s.name = "\xff"; }).find("/name: is not UTF-8"), std::string::npos);
    EXPECT_NE(fault_with([](Scene& s) { s.loads = {UserTorque{"none", {}, {}}}; }).find("/loads/0"), std::string::npos);
    EXPECT_NE(fault_with([](Scene& s) {
                  s.pivot = Vector3<double>();
                  s.initial.velocity_W[0] = 1;
              }).find("/initial/velocity: is given, but the scene has a pivot"),
              std::string::npos);
    // finite numbers whose inverse or product overflows
    EXPECT_NE(fault_with([](Scene& s) { s.body.mass = 5e-324; }).find("/body/mass"), std::string::npos);
    EXPECT_NE(fault_with([](Scene& s) {
                  s.body.mass = 1e300;
                  s.pivot = Vector3<double>(1e10, 0, 0);
              }).find("/pivot: makes the inertia"),
              std::string::npos);
    // a tensor below the resolution of 113 bits beside the contribution of the pivot's distance
    for (const Vector3<double>& arm : {Vector3<double>(0.3, 0.4, 0.5), Vector3<double>(0, 0, 0.5)})
        EXPECT_NE(fault_with([&](Scene& s) {
                      s.body.mass = 1;
                      s.body.inertia_B = diagonal(Vector3<double>(1e-55, 1.2e-55, 1.5e-55));
                      s.body.center_of_mass = arm;
                      s.pivot = Vector3<double>();
                  }).find("/pivot: makes a principal moment about the pivot less than 1e-30 of the largest, "),
                  std::string::npos);
    // a needle with the pivot on its own axis is valid
    EXPECT_EQ(fault_with([](Scene& s) {
                  s.body.mass = 1;
                  s.body.inertia_B = diagonal(Vector3<double>(1e-55, 1, 1));
                  s.body.center_of_mass = {0.5, 0, 0};
                  s.pivot = Vector3<double>();
              }),
              "");
}

// The triangle inequality applies to the principal moments, so rotating a tensor does not change the result.
RC_GTEST_PROP(Validate, JudgesATensorByItsPrincipalMoments, ()) {
    // of similar size, so that the other two inequalities are not near their limits
    const double a = positive_number(), b = a * *rc::gen::element(0.1, 0.7, 1.0, 3.0, 10.0);
    // the third moment differs from the sum of the others by more than the rounding of the rotated tensor
    const double excess = *rc::gen::element(-1e-3, 1e-3), third = (a + b) * (1 + excess);
    const Matrix3<double> R = rotation_matrix(random_orientation());
    Matrix3<double> J = R * diagonal(Vector3<double>(a, b, third)) * transposed(R);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < i; ++j) J[i][j] = J[j][i];
    const std::string message = fault_with([&](Scene& s) { s.body.inertia_B = J; });
    RC_LOG() << message;
    RC_ASSERT(message.empty() == (excess < 0));
}

}  // namespace
}  // namespace polhode
