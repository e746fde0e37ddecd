// Further engine updates: published figures, the equation that each step solves, invariants and convergence.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <string_view>

#include "body/orientation.h"
#include "integrators/game/game_scenes.h"
#include "motion/exact_body.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

using namespace polhode::testing;

constexpr std::array<const char*, 6> engine_updates{"midpoint_gyroscopic", "momentum_exponential_map",
                                                    "damped_implicit",     "gyroscopic_linearly_implicit",
                                                    "mujoco_rk4",          "xpbd_rigid"};

double energy_of_turning(const Scene& scene, const Sample& s) {
    return dot(s.angular_velocity_B, scene.body.inertia_B * s.angular_velocity_B) / 2;
}
Vector3<double> momentum_of(const Scene& scene, const Sample& s) {
    return rotate(s.q, scene.body.inertia_B * s.angular_velocity_B);
}
double norm(const Vector3<double>& v) { return std::sqrt(dot(v, v)); }
Sample end_of(const Scene& scene, const char* method, double h) {
    const Trajectory trajectory = with_step(scene, method, h);
    EXPECT_EQ(trajectory.status, Status::ok) << method << ": " << trajectory.message;
    return trajectory.samples.empty() ? Sample{} : trajectory.samples.back();
}

/// MuJoCo's test engine_forward_test.cc: E/E0 after 5 s at h = 0.01 s is 0.93 with implicitfast of version 3.11 and
/// later. Versions 3.7 to 3.10 conserved it by the midpoint rule, and the manual recommends RK4 for conservation.
TEST(EngineUpdates, HaveTheEnergiesOfMuJoCosOwnTest) {
    const Scene scene = find_scene("mujoco_box");
    const auto ratio = [&](const char* method) {
        const Trajectory trajectory = with_step(scene, method, 0.01);
        EXPECT_EQ(trajectory.steps, 500);
        return energy_of_turning(scene, trajectory.samples.back()) /
               energy_of_turning(scene, trajectory.samples.front());
    };
    EXPECT_NEAR(ratio("mujoco_rk4"), 1, 1e-6);
    EXPECT_NEAR(ratio("midpoint_gyroscopic"), 1, 1e-10);
    EXPECT_NEAR(ratio("damped_implicit"), 0.926, 5e-4);
}

/// One step of a free body satisfies the method's equations in body axes.
TEST(EngineUpdates, StepsSolveTheirEquations) {
    const double h = 0.125;
    const Scene scene = free_body(h);
    const Matrix3<double>& I = scene.body.inertia_B;
    const Vector3<double> w0 = scene.initial.angular_velocity, L0 = I * w0;
    // I (w - w0) + h m x I m = 0 at m = (w + w0)/2
    const Vector3<double> w1 = end_of(scene, "midpoint_gyroscopic", h).angular_velocity_B, mean = 0.5 * (w0 + w1);
    EXPECT_LT(norm(I * (w1 - w0) + h * cross(mean, I * mean)), 1e-14);
    // (I - h skew(I w0)) w = I w0, and the energy that this takes from a free body
    const Sample linear = end_of(scene, "gyroscopic_linearly_implicit", h);
    const Vector3<double> wl = linear.angular_velocity_B, change = wl - w0;
    EXPECT_LT(norm(I * change - h * cross(L0, wl)), 1e-14);
    EXPECT_NEAR(dot(w0, L0) - dot(wl, I * wl), dot(change, I * change), 1e-14);
    EXPECT_GT(norm(change), 0.1);
    // from the identity, L = I w0 rotates the body by h w0, and L stays constant
    const Sample turned = end_of(scene, "momentum_exponential_map", h);
    EXPECT_LT(attitude_error(turned.q, quaternion_from_rotation_vector(h * w0)), 1e-15);
    EXPECT_LT(distance(turned.angular_velocity_B, inverse(I) * rotate_back(turned.q, L0)), 1e-15);
    // q rotates by 2 atan(h |w| / 2) about w = w0 - h I^-1 (w0 x I w0), and the reported |w| is 2 sin(half of it) / h
    const Vector3<double> w = w0 + h * (inverse(I) * cross(L0, w0));
    const double angle = 2 * std::atan(h * norm(w) / 2);
    const Sample moved = end_of(scene, "xpbd_rigid", h);
    EXPECT_LT(attitude_error(moved.q, quaternion_from_rotation_vector((angle / norm(w)) * w)), 1e-15);
    EXPECT_LT(distance(moved.angular_velocity_B, (2 * std::sin(angle / 2) / h / norm(w)) * w), 1e-14);
}

/// mj_RungeKutta as in MuJoCo's source: sums over the whole tableau, quaternions by mju_quatIntegrate.
TEST(MujocoRk4, IsTheListing) {
    const double h = 0.125;
    const Scene scene = free_body(h);
    const Matrix3<double>& I = scene.body.inertia_B;
    constexpr double A[3][3] = {{0.5, 0, 0}, {0, 0.5, 0}, {0, 0, 1}}, B[4] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
    Vector3<double> X[4], F[4], dX, dV;
    X[0] = scene.initial.angular_velocity;
    for (int i = 0; i < 4; ++i) {
        if (i > 0) X[i] = X[0];
        for (int j = 0; j < i; ++j) X[i] = X[i] + h * A[i - 1][j] * F[j];
        F[i] = inverse(I) * cross(I * X[i], X[i]);
    }
    for (int i = 0; i < 4; ++i) dX = dX + B[i] * X[i], dV = dV + B[i] * F[i];
    const Sample end = end_of(scene, "mujoco_rk4", h);
    EXPECT_LT(distance(end.angular_velocity_B, X[0] + h * dV), 1e-15);
    EXPECT_LT(attitude_error(end.q, quaternion_from_rotation_vector(h * dX)), 1e-15);
}

/// The attitude has order 2. On a free body w and the energy, which do not depend on the attitude, have order 4.
TEST(MujocoRk4, HasOrderTwoInAttitudeAndFourInTheRate) {
    const Scene scene = free_body(3);
    const Sample truth = with_tolerance(scene, "odeint_fehlberg78", 1e-13).samples.back();
    const auto coarse = end_errors(scene, "mujoco_rk4", 0.02, truth),
               fine = end_errors(scene, "mujoco_rk4", 0.01, truth);
    EXPECT_NEAR(std::log2(coarse[0] / fine[0]), 2, 0.05);
    EXPECT_NEAR(std::log2(coarse[1] / fine[1]), 4, 0.1);
    EXPECT_LT(fine[1], 1e-8);
}

/// Under loads that depend on the attitude everything has order 2.
TEST(MujocoRk4, ConvergesWithOrderTwoUnderEveryLoad) {
    expect_convergence(everything(2), "mujoco_rk4", 1e-2, 2, 1e-3);
    expect_convergence(held(1), "mujoco_rk4", 2e-3, 2, 1e-3);
}

TEST(EngineUpdates, ConvergeWithOrderOneUnderEveryLoad) {
    for (const char* method : {"midpoint_gyroscopic", "gyroscopic_linearly_implicit", "momentum_exponential_map",
                               "damped_implicit", "xpbd_rigid"})
        expect_convergence(everything(2), method, 2e-4, 1, 0.02);
}

TEST(EngineUpdates, ConvergeWithOrderOneOnAHeldBody) {
    for (const char* method : {"midpoint_gyroscopic", "gyroscopic_linearly_implicit", "momentum_exponential_map",
                               "damped_implicit", "xpbd_rigid"})
        expect_convergence(held(1), method, 1e-4, 1, 0.05);
}

/// The energy and |L| of a free body are conserved for any step; the direction of L changes.
TEST(MidpointGyroscopic, KeepsTheEnergyAndTheLengthOfTheMomentum) {
    for (const double h : {0.01, 0.5}) {
        const Scene scene = free_body(2000 * h);
        const Trajectory trajectory = with_step(scene, "midpoint_gyroscopic", h, 100);
        const Sample& start = trajectory.samples.front();
        double turned = 0;
        for (const Sample& s : trajectory.samples) {
            EXPECT_NEAR(energy_of_turning(scene, s), energy_of_turning(scene, start), 1e-11);
            EXPECT_NEAR(norm(momentum_of(scene, s)), norm(momentum_of(scene, start)), 1e-11);
            turned = std::max(turned, distance(momentum_of(scene, s), momentum_of(scene, start)));
        }
        EXPECT_GT(turned, 1e-3);
    }
}

/// L in world axes is conserved, including its direction; under a torque it changes by the exact impulse.
TEST(MomentumExponentialMap, KeepsTheMomentum) {
    Scene scene = free_body(1000);
    for (const double h : {0.01, 0.5})
        for (const Sample& s : with_step(scene, "momentum_exponential_map", h, 100).samples)
            EXPECT_LT(distance(momentum_of(scene, s), Vector3<double>(1, 2, 3)), 1e-14) << h;
    scene.duration = 8;
    const Vector3<double> torque(0.25, -0.5, 0.125);
    scene.loads = {Torque{torque, Frame::world, {}}};
    const Sample end = end_of(scene, "momentum_exponential_map", 0.125);
    EXPECT_LT(distance(momentum_of(scene, end), Vector3<double>(1, 2, 3) + 8.0 * torque), 1e-13);
}

/// Without drag it equals the implicit gyroscopic update up to rounding.
TEST(DampedImplicit, IsTheImplicitGyroscopicUpdateWithoutDrag) {
    const Scene scene = free_body(10);
    const Sample damped = end_of(scene, "damped_implicit", 0.01), plain = end_of(scene, "gyroscopic_implicit", 0.01);
    EXPECT_LT(attitude_error(damped.q, plain.q), 1e-12);
    EXPECT_LT(distance(damped.angular_velocity_B, plain.angular_velocity_B), 1e-12);
}

/// (I + h D + h (skew(w) I - skew(I w))) (w' - w) = h (-D w - w x I w), and (1 + h c/m) v' = v.
TEST(DampedImplicit, TakesDragAndTheGyroscopicTermInOneSolve) {
    const double h = 0.125;
    Scene scene = free_body(h);
    scene.body.mass = 2;
    scene.initial.velocity_W = {1, -2, 3};
    scene.loads = {Drag{{3, 1, 2}, 4, {}}};
    const Matrix3<double>&I = scene.body.inertia_B, D = diagonal(Vector3<double>(3, 1, 2));
    const Vector3<double> w = scene.initial.angular_velocity;
    const Sample end = end_of(scene, "damped_implicit", h);
    const Vector3<double> change = end.angular_velocity_B - w;
    const Vector3<double> left = I * change + h * (D * change + cross(w, I * change) + cross(change, I * w));
    EXPECT_LT(distance(left, -h * (D * w + cross(w, I * w))), 1e-14);
    EXPECT_LT(distance(1.25 * end.velocity_W, scene.initial.velocity_W), 1e-14);
    EXPECT_LT(distance(end.position_W, h * end.velocity_W), 1e-14);
}

/// Drag with rates of 500 and 1000 /s at h = 0.01 s, where explicit steps diverge.
TEST(DampedImplicit, StandsStiffDrag) {
    Scene scene = free_body(10);
    scene.initial.velocity_W = {1, 0, 0};
    scene.loads = {Drag{{1000, 1000, 1500}, 1000, {}}};
    const Sample end = end_of(scene, "damped_implicit", 0.01);
    EXPECT_LT(norm(end.angular_velocity_B), 1e-12);
    EXPECT_LT(norm(end.velocity_W), 1e-12);
    EXPECT_EQ(with_step(scene, "gyroscopic_implicit", 0.01).status, Status::diverged);
}

/// The pivot stays at the world's origin up to O(h^2), the error of one solve of the constraint: a heavy top, and a
/// body held at a point other than its origin.
TEST(XpbdRigid, HoldsThePivot) {
    for (const Scene& scene : {heavy_top(1), held(1)}) {
        const Vector3<double> arm = *scene.pivot - scene.body.center_of_mass;
        const auto farthest = [&](double h) {
            const Trajectory trajectory = with_step(scene, "xpbd_rigid", h, 50);
            EXPECT_EQ(trajectory.status, Status::ok) << trajectory.message;
            double most = 0;
            for (const Sample& s : trajectory.samples) most = std::max(most, norm(s.position_W + rotate(s.q, arm)));
            return most;
        };
        const double off = farthest(1e-3);
        EXPECT_GT(off, 0);
        EXPECT_LT(off, 1e-5);
        EXPECT_NEAR(std::log2(off / farthest(5e-4)), 2, 0.1);
    }
}

/// The reported w is smaller than the applied rotation rate by the relative amount (h |w|)^2 / 8 at every step.
TEST(XpbdRigid, TakesAPartOfTheRateAway) {
    Scene ball;
    ball.name = "ball", ball.duration = 1;
    ball.initial.angular_velocity = {1, -2, 2};
    for (const double h : {0.01, 0.005}) {
        const double lost = 1 - norm(end_of(ball, "xpbd_rigid", h).angular_velocity_B) / 3;
        EXPECT_NEAR(lost / (9 * h / 8), 1, 0.05);
    }
}

/// Rounding can place an event next to the end of a step, so that 10^-17 s of the step remain: here at 0.3 and 0.7 s
/// with 0.1 s steps. Over this time velocities cannot be computed from positions, nor the pivot corrected. Some
/// events leave more time.
TEST(XpbdRigid, KeepsItsVelocitiesOverWhatEventsLeaveOfAStep) {
    for (const char* method : {"xpbd_rigid", "xpbd_rigid_float32"})
        for (const double h : {0.1, 0.001})
            for (const double begin : {0.3, 0.7, 0.30000000001, 0.3000001, 0.30001}) {
                Scene scene = free_body(1);
                scene.initial.position_W = {3, 1, 2}, scene.initial.velocity_W = {1, -2, 3};
                const Sample plain = end_of(scene, method, h);
                scene.loads = {Torque{{1e-12, 0, 0}, Frame::body, {begin, 1}}};
                const Sample cut = end_of(scene, method, h);
                const double rounding = std::string_view(method).ends_with("float32") ? 0.01 : 1e-10;
                EXPECT_LT(distance(cut.velocity_W, scene.initial.velocity_W), rounding) << method << h << ' ' << begin;
                EXPECT_LT(distance(cut.position_W, plain.position_W), rounding) << method << h << ' ' << begin;
                // a short remainder keeps its part of w and rotates as a step by itself
                EXPECT_LT(distance(cut.angular_velocity_B, plain.angular_velocity_B), rounding + h * h)
                    << method << h << ' ' << begin;
            }
    for (const double begin : {0.3, 0.7, 0.30000000001, 0.3000001, 0.30001}) {
        Scene scene = heavy_top(1);
        scene.initial.angular_velocity = {0, 0, 4};
        const Sample plain = end_of(scene, "xpbd_rigid", 0.001);
        scene.loads.emplace_back(Torque{{1e-12, 0, 0}, Frame::body, {begin, 1}});
        const Sample cut = end_of(scene, "xpbd_rigid", 0.001);
        EXPECT_LT(attitude_error(cut.q, plain.q), 1e-3) << begin;
        EXPECT_LT(distance(cut.angular_velocity_B, plain.angular_velocity_B), 1e-2) << begin;
    }
}

/// The float32 variants follow the binary64 ones over n steps of 0.01 s. The difference is about 2^-24 per step and
/// acts on through the rates; it is n times larger where rates are differences divided by h.
TEST(EngineUpdates, HaveTwinsInBinary32ThatFollowThem) {
    for (const Scene& scene : {everything(2), held(1)})
        for (const char* name : engine_updates) {
            const double h = 0.01, n = scene.duration / h;
            const Sample wide = end_of(scene, name, h),
                         narrow = end_of(scene, (std::string(name) + "_float32").c_str(), h);
            const double bound = 0x1p-24 * n * (name == std::string_view("xpbd_rigid") ? n : 10);
            const double apart = attitude_error(narrow.q, wide.q);
            EXPECT_GT(apart, 0) << name << " on " << scene.name;
            EXPECT_LT(apart, bound) << name << " on " << scene.name;
            EXPECT_LT(distance(narrow.angular_velocity_B, wide.angular_velocity_B), 2 * bound) << name << scene.name;
            EXPECT_LT(distance(narrow.position_W, wide.position_W), bound) << name << " on " << scene.name;
            EXPECT_LT(distance(narrow.velocity_W, wide.velocity_W), bound) << name << " on " << scene.name;
        }
}

}  // namespace
}  // namespace polhode
