// Methods in binary32: rounding errors separated from those of the method, descriptors, limits of binary32's range.
#include "integrators/run/binary32.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "build_kind.h"
#include "integrators/scenes.h"

namespace polhode {
namespace {

using namespace polhode::testing;

constexpr std::string_view suffix = "_float32";
constexpr double unit_roundoff = 0x1p-24;

std::vector<const Method*> in_binary32() {
    std::vector<const Method*> found;
    for (const Method* method : methods())
        if (method->name.ends_with(suffix)) found.push_back(method);
    return found;
}
const Method& in_binary64(const Method& method) {
    return *find_method(method.name.substr(0, method.name.size() - suffix.size()));
}
double largest(const Vector3<double>& v) { return std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])}); }

class Binary32Method : public ::testing::TestWithParam<const Method*> {};

/// Each one follows its binary64 method in the list, with the same properties.
TEST_P(Binary32Method, FollowsItsMethod) {
    const Method& narrow = *GetParam();
    const auto place = std::find(methods().begin(), methods().end(), &narrow);
    ASSERT_NE(place, methods().begin());
    const Method& wide = **(place - 1);
    EXPECT_EQ(std::string(narrow.name), std::string(wide.name) + std::string(suffix));
    EXPECT_EQ(narrow.order, wide.order);
    EXPECT_EQ(narrow.control, wide.control);
    EXPECT_EQ(narrow.source, wide.source);
    EXPECT_TRUE(narrow.documentation.starts_with("`" + std::string(wide.name) + "` in binary32"));
    EXPECT_TRUE(narrow.documentation.ends_with(wide.documentation));
    EXPECT_TRUE(narrow.conserves.starts_with(wide.conserves));
}

/// The same steps in both arithmetics, on a tumbling body and a top. At coarse steps both have the error of the
/// method. At fine steps they differ by rounding: at worst 2^-24 per step in the attitude and in the rates, whose
/// relative error is multiplied by the rotated angle.
TEST_P(Binary32Method, DiffersFromBinary64ByItsRoundingAlone) {
    const Method &narrow = *GetParam(), &wide = in_binary64(narrow);
    if (!refusal(wide, pose(free_body(2))).empty()) GTEST_SKIP() << "of scenes of several bodies: multibody/";
    // these transform w to body axes and back at every step, one of them four times
    const bool takes_rates_round =
        narrow.name.starts_with("gyroscopic") || narrow.name.starts_with("first_order") || narrow.planes;
    const double roundings = takes_rates_round ? 6 : 1;
    for (const Scene& scene : {free_body(2), heavy_top(1)}) {
        const Vector3<double>& w = scene.initial.angular_velocity;
        const double angle = std::sqrt(dot(w, w)) * scene.duration;
        const Quaternion<double> truth = with_tolerance(scene, "odeint_fehlberg78", 1e-13).samples.back().q;
        const auto both = [&](long n) {
            const double h = scene.duration / static_cast<double>(n);
            return std::pair(with_step(scene, narrow.name.data(), h), with_step(scene, wide.name.data(), h));
        };
        const auto attitude = [](const Trajectory& trajectory) { return trajectory.samples.back().q; };
        // the coarsest useful steps; some methods converge to another motion
        for (long n = 4;; n *= 2) {
            const auto [single, binary64] = both(n);
            if (single.status != Status::ok || binary64.status != Status::ok) continue;
            const double method_error = attitude_error(attitude(binary64), truth);
            if (method_error > 0.1 && n < 256) continue;
            ASSERT_GT(method_error, 1e-4) << scene.name << " " << n;
            // ten substeps per step, each of which rounds
            const bool substeps = narrow.name.starts_with("xpbd_contacts");
            EXPECT_LT(attitude_error(attitude(single), attitude(binary64)), (substeps ? 0.03 : 0.01) * method_error)
                << scene.name;
            // the observed order agrees as well; order_test.cpp measures it in binary64 down to round-off
            const auto [half_single, half_binary64] = both(2 * n);
            ASSERT_EQ(half_single.status, Status::ok) << half_single.message;
            const double single_order = std::log2(attitude_error(attitude(single), truth) /
                                                  attitude_error(attitude(half_single), truth)),
                         order = std::log2(method_error / attitude_error(attitude(half_binary64), truth));
            EXPECT_NEAR(single_order, order, substeps ? 0.1 : 0.05) << scene.name;
            break;
        }
        // velocities that are position differences divided by h have rounding errors proportional to 1/h
        if (narrow.name.starts_with("xpbd_")) continue;
        const long n = optimised_build ? 16384 : 2048;
        const auto [single, binary64] = both(n);
        ASSERT_EQ(single.status, Status::ok) << single.message;
        const double apart = attitude_error(attitude(single), attitude(binary64));
        const double bound = roundings * unit_roundoff * static_cast<double>(n) * (1 + angle);
        RecordProperty(scene.name.substr(0, 4), std::to_string(apart / bound));
        EXPECT_LT(apart, bound) << scene.name;
        // for a method of order 4, rounding is then the whole error
        if (narrow.order == 4) {
            EXPECT_GT(attitude_error(attitude(single), truth), 100 * attitude_error(attitude(binary64), truth));
        }
    }
}

/// On a free body the invariants of the method, |q| = 1 or the vector L, are conserved up to rounding.
TEST(Binary32, KeepsWhatTheMethodKeeps) {
    const Scene scene = free_body(10);
    const Vector3<double> L0(1, 2, 3);
    for (const char* name : {"fleck_quaternion_float32", "splitting2_float32", "moser_veselov2_float32", "buss_float32",
                             "simo_wong_float32"})
        for (const Sample& s : with_step(scene, name, 0.01, 20).samples) {
            // R L_B contains the rounding of the attitude
            const Vector3<double> L =
                (1 / squared_norm(s.q)) * rotate(s.q, scene.body.inertia_B * s.angular_velocity_B);
            EXPECT_LT(largest(L - L0), 1e-5) << name;
            EXPECT_NEAR(squared_norm(s.q), 1, 1e-6) << name;
        }
}

/// Motions beyond the range of binary32 are refused.
TEST_P(Binary32Method, RefusesNumbersBeyondItsRange) {
    if (refusal(*find_method(GetParam()->name), pose(free_body(1))).find("several bodies") != std::string::npos)
        GTEST_SKIP() << "a free body is none of its motions";
    const auto refused = [&](const Scene& scene, double h) {
        const Trajectory trajectory = with_step(scene, GetParam()->name.data(), h);
        EXPECT_EQ(trajectory.status, Status::unsupported) << trajectory.message;
        EXPECT_NE(trajectory.message.find("binary32"), std::string::npos) << trajectory.message;
    };
    Scene scene = free_body(1);
    scene.body.inertia_B = diagonal(Vector3<double>(1e-150, 2e-150, 2e-150));
    refused(scene, 0.1);
    scene = free_body(1);
    scene.initial.angular_velocity = {1e40, 0, 0};
    refused(scene, 0.1);
    scene = free_body(1e-42);
    refused(scene, 1e-43);
}

/// A torque accelerates the body until w, or a term of a step, exceeds 3.4e38: the run reports it and returns no NaN.
TEST_P(Binary32Method, DivergesByNameBeyondItsRange) {
    for (const double torque : {1e38, 1e20, 1e10}) {
        Scene scene = free_body(100);
        scene.loads = {Torque{{torque, 2 * torque, -torque}, Frame::body, {}}};
        // rotation about one axis, so that w only grows
        if (torque > 1e30)
            scene.initial.angular_velocity = {0, 0, 1}, scene.loads = {Torque{{0, 0, torque}, Frame::body, {}}};
        const Trajectory trajectory = with_step(scene, GetParam()->name.data(), 1, 10);
        if (trajectory.status == Status::ok) {
            EXPECT_EQ(trajectory.samples.size(), 11U);
        } else {
            EXPECT_FALSE(trajectory.message.empty());
        }
        for (const Sample& s : trajectory.samples) {
            EXPECT_TRUE(all_finite(s.q) && all_finite(s.angular_velocity_B)) << torque;
        }
        if (torque > 1e30) {
            EXPECT_NE(trajectory.status, Status::ok);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Methods, Binary32Method, ::testing::ValuesIn(in_binary32()),
                         [](const auto& of) { return std::string(of.param->name); });

}  // namespace
}  // namespace polhode
