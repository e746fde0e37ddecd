// Invariants derived from the loads, compared with a run of the full equations (13 variables, the tensor as given).
#include "motion/conserved.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "motion/systems.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

// Classical Runge-Kutta for the full system; steps end at events.
std::vector<Sample> run(const Scene& scene, double step) {
    const Problem problem = pose(scene, Formulation::full);
    FullMotion f(problem);
    constexpr int n = FullMotion::dimension;
    double y[n], k[4][n], z[n];
    f.initial(y);
    std::vector<Sample> samples;
    for (const Segment& segment : problem.segments) {
        f.enter(segment, y);
        samples.push_back(f.motion(segment.begin, y));
        const long steps = std::max(1L, std::lround(std::ceil((segment.end - segment.begin) / step)));
        const double h = (segment.end - segment.begin) / static_cast<double>(steps);
        for (long s = 0; s < steps; ++s) {
            const double t = segment.begin + static_cast<double>(s) * h;
            f.derivative(t, y, k[0]);
            for (int stage = 1; stage < 4; ++stage) {
                const double c = stage == 3 ? h : h / 2;
                for (int i = 0; i < n; ++i) z[i] = y[i] + c * k[stage - 1][i];
                f.derivative(t + c, z, k[stage]);
            }
            for (int i = 0; i < n; ++i) y[i] += h / 6 * (k[0][i] + 2 * (k[1][i] + k[2][i]) + k[3][i]);
            samples.push_back(f.motion(t + h, y));
        }
    }
    return samples;
}

// The relative error of RK4 at h = 1e-3 s with rates up to about 5 per second over 3 s is t (5 h)^4 5 / 120 ~ 1e-10.
// The largest measured change is 2e-11, of quantities up to 100. Quantities not conserved change by more than 1e-3.
constexpr double followed_step = 1e-3, conserved_tolerance = 1e-8, changed_tolerance = 1e-3;

double largest_change(const Problem& problem, const Conserved& one, const std::vector<Sample>& samples) {
    double change = 0;
    for (const Sample& sample : samples) {
        const std::vector<double> now = one.of(problem, one, sample);
        for (std::size_t i = 0; i < now.size(); ++i) change = std::max(change, std::abs(now[i] - one.value[i]));
    }
    return change;
}

std::vector<std::string> names(const std::vector<Conserved>& all) {
    std::vector<std::string> list;
    for (const Conserved& one : all) list.push_back(one.name);
    return list;
}

// Every claimed invariant is constant along the run. Energy and angular momentum change if they are not claimed.
void expect(const Scene& scene, const std::vector<std::string>& wanted) {
    const Problem problem = pose(scene);
    const std::vector<Conserved> all = conserved(problem);
    EXPECT_EQ(names(all), wanted);
    const std::vector<Sample> samples = run(scene, followed_step);
    for (const Conserved& one : all) EXPECT_LT(largest_change(problem, one, samples), conserved_tolerance) << one.name;
    const auto claims = [&](const char* name) { return std::find(wanted.begin(), wanted.end(), name) != wanted.end(); };
    const ExactBody<double>& body = problem.body;
    double energy = 0, momentum = 0;
    std::optional<Invariants<double>> first;
    for (const Sample& s : samples) {
        const Invariants<double> now = invariants(scene, body, std::min(s.t, scene.duration * (1 - 1e-9)), s.q,
                                                  s.angular_velocity_B, s.position_W, s.velocity_W);
        if (!first) first = now;
        energy = std::max(energy, std::abs(now.energy - first->energy));
        const Vector3<double> change = now.angular_momentum_W - first->angular_momentum_W;
        momentum = std::max(momentum, std::sqrt(dot(change, change)));
    }
    EXPECT_EQ(claims("energy"), energy < changed_tolerance) << energy;
    EXPECT_EQ(claims("angular momentum"), momentum < changed_tolerance) << momentum;
}

Scene tumbling() {
    Scene s;
    s.name = "tumbling", s.duration = 3;
    s.body.inertia_B = diagonal(Vector3<double>(1, 2, 2.5));
    s.initial.angular_velocity = {1, 2, -1};
    return s;
}

Scene top() {
    Scene s = tumbling();
    s.body.inertia_B = diagonal(Vector3<double>(0.75, 0.75, 0.5));
    s.body.center_of_mass = {0, 0, 0.5};
    s.pivot = Vector3<double>();
    s.loads = {Gravity{{0, 0, -10}, {}}};
    s.initial.orientation = {0.8, 0.6, 0, 0};
    return s;
}

const char* const E_kept = "energy";
const char* const L_kept = "angular momentum";
const char* const Lu_kept = "angular momentum along u";
const char* const P_kept = "linear momentum";
const char* const Pu_kept = "linear momentum along u";
const char* const spin_kept = "spin about the axis of symmetry";

TEST(Conserved, FreeBodyKeepsEverything) {
    Scene s = tumbling();
    s.initial.velocity_W = {1, 2, 3};
    expect(s, {E_kept, L_kept, P_kept});
}

TEST(Conserved, FreeSymmetricBodyKeepsItsSpin) {
    Scene s = tumbling();
    s.body.inertia_B = diagonal(Vector3<double>(2, 1, 2));
    expect(s, {E_kept, L_kept, P_kept, spin_kept});
}

TEST(Conserved, ThrownBodyKeepsTwoComponentsOfItsMomentum) {
    Scene s = tumbling();
    s.loads = {Gravity{{0, 3, -10}, {}}};
    s.initial.velocity_W = {1, 2, 3};
    expect(s, {E_kept, L_kept, Pu_kept, Pu_kept});
}

TEST(Conserved, HeavyTopKeepsTheVerticalMomentumAndItsSpin) { expect(top(), {E_kept, Lu_kept, spin_kept}); }

TEST(Conserved, TopWithItsCentreOfMassOffTheAxisLosesTheSpin) {
    Scene s = top();
    s.body.center_of_mass = {0.1, 0, 0.5};
    expect(s, {E_kept, Lu_kept});
}

TEST(Conserved, TopInTiltedGravityKeepsTheMomentumAlongIt) {
    Scene s = top();
    s.loads = {Gravity{{6, 0, -8}, {}}};
    expect(s, {E_kept, Lu_kept, spin_kept});
    const std::vector<Conserved> all = conserved(pose(s));
    EXPECT_NEAR(std::abs(dot(all[1].direction, Vector3<double>(0.6, 0, -0.8))), 1, 1e-15);
}

TEST(Conserved, SphericalTopKeepsTheMomentumAlongItsArm) {
    Scene s = top();
    s.body.inertia_B = diagonal(Vector3<double>(0.75, 1, 0.5));
    s.body.center_of_mass = {0, 0.5, 0};  // the parallel axis theorem adds 0.25, 0, 0.25
    s.body.inertia_B = diagonal(Vector3<double>(0.75, 1, 0.75));
    expect(s, {E_kept, Lu_kept, spin_kept});
}

TEST(Conserved, KovalevskayasTopHasItsIntegral) {
    expect(find_scene("kovalevskaya"), {E_kept, Lu_kept, "Kovalevskaya's integral"});
    // the same body in other body axes: the equator is still found
    Scene s = find_scene("kovalevskaya");
    s.duration = 3;
    s.body.inertia_B = diagonal(Vector3<double>(0.75, 2, 1.75));
    s.body.center_of_mass = {0, 0.5, 0};
    expect(s, {E_kept, Lu_kept, "Kovalevskaya's integral"});
}

TEST(Conserved, GoryachevAndChaplyginsTopHasItsIntegralWhereTheVerticalMomentumVanishes) {
    const char* const integral = "Goryachev and Chaplygin's integral";
    Scene s = find_scene("goryachev_chaplygin");
    s.duration = 3;
    expect(s, {E_kept, Lu_kept, integral});
    // the same body in other body axes, with its rates in these axes
    Scene other = s;
    other.body.inertia_B = diagonal(Vector3<double>(0.75, 4, 3.75));
    other.body.center_of_mass = {0, 0.5, 0};
    other.initial.orientation = {0.5, -0.5, -0.5, -0.5};  // maps x, y, z of this body to z, x, y of the first one
    other.initial.angular_velocity = {0, 0.5, 1};
    expect(other, {E_kept, Lu_kept, integral});
    s.initial.angular_velocity = {0.5, 1, 0.25};
    expect(s, {E_kept, Lu_kept});
}

TEST(Conserved, SpringKeepsTheEnergyAlone) {
    Scene s = tumbling();
    s.loads = {Spring{5, {0.8, 0, 0.6, 0}, {}}};
    expect(s, {E_kept, P_kept});
}

TEST(Conserved, DragKeepsNothing) {
    Scene s = tumbling();
    s.initial.velocity_W = {1, 0, 0};
    s.loads = {Drag{{0.1, 0.2, 0.3}, 0.5, {}}};
    expect(s, {});
}

TEST(Conserved, WorldTorqueKeepsTheMomentumAcrossIt) {
    Scene s = tumbling();
    s.loads = {Torque{{0, 1, 1}, Frame::world, {}}};
    expect(s, {Lu_kept, Lu_kept, P_kept});
    s.loads.push_back(Torque{{1, 0, 0}, Frame::world, {1, 2}});
    expect(s, {Lu_kept, P_kept});
    s.loads.push_back(Torque{{0, 0, 1}, Frame::world, {2, 3}});
    expect(s, {P_kept});
}

TEST(Conserved, WindowsBreakTheEnergyNotTheMomentumAlongTheField) {
    Scene s = top();
    s.loads = {Gravity{{0, 0, -10}, {1, 2}}};
    expect(s, {Lu_kept, spin_kept});
}

TEST(Conserved, ImpulsesBreakWhatTheyKick) {
    Scene s = tumbling();
    s.loads = {Impulse{{0, 0, 2}, Frame::world, {0.5, 0, 0}, Frame::body, 1}};
    expect(s, {Lu_kept, Pu_kept, Pu_kept});
    // an impulse at t = 0 acts before the first sample
    s.loads = {Impulse{{0, 0, 2}, Frame::world, {0.5, 0, 0}, Frame::body, 0}};
    expect(s, {E_kept, L_kept, P_kept});
}

TEST(Conserved, TwoFieldsOfDifferentDirectionsKeepTheEnergyAlone) {
    Scene s = top();
    s.loads.push_back(Force{{3, 0, 0}, Frame::world, {0, 0.5, 0}, Frame::body, {}});
    expect(s, {E_kept});
}

TEST(Conserved, ForceFixedInTheWorldInFlight) {
    Scene s = tumbling();
    s.loads = {Force{{0, 0, 2}, Frame::world, {0.5, 0, 0}, Frame::body, {}}};
    expect(s, {E_kept, Lu_kept, Pu_kept, Pu_kept});
    s.loads = {Force{{0, 0, 2}, Frame::world, {0.5, 0, 0}, Frame::world, {}}};
    expect(s, {Lu_kept, Pu_kept, Pu_kept});
    s.loads = {Force{{0, 0, 2}, Frame::body, {0.5, 0, 0}, Frame::body, {}}};
    expect(s, {});
}

}  // namespace
}  // namespace polhode
