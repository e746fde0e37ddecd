// Structure-preserving methods: drift of conserved quantities over many steps, coefficients of the methods, refusals.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "body/orientation.h"
#include "build_kind.h"
#include "integrators/geometric/composition.h"
#include "integrators/geometric/free_flows.h"
#include "integrators/scenes.h"
#include "measure/growth.h"
#include "motion/conserved.h"

namespace polhode {
namespace {

using namespace polhode::testing;

// 10^6 steps of 1/100 s, fewer in builds without optimisation
constexpr long most_structure_steps = optimised_build ? 1'000'000 : 10'000;
constexpr double structure_step = 0.01;

/// The drift at a thousand times: energy and |L| relative to their size, L_W as a vector, and the length of q.
struct Drift {
    std::vector<double> t, energy, momentum, momentum_length, momentum_z, norm;
};

double worst(const std::vector<double>& values) { return *std::max_element(values.begin(), values.end()); }

Drift drift(const Scene& described, const char* method, long steps, double h) {
    Scene scene = described;
    scene.duration = h * static_cast<double>(steps);
    const ExactBody<double> body = exact_body<double>(scene);
    const Trajectory trajectory = with_step(scene, method, h, 1000);
    EXPECT_EQ(trajectory.status, Status::ok) << method << ": " << trajectory.message;
    Drift found;
    Invariants<double> start;
    for (const Sample& s : trajectory.samples) {
        const double length = std::sqrt(squared_norm(s.q));
        const Quaternion<double> q{s.q.w / length, s.q.x / length, s.q.y / length, s.q.z / length};
        const Invariants<double> now =
            invariants(scene, body, s.t, q, s.angular_velocity_B, s.position_W, s.velocity_W);
        if (s.t == 0) start = now;
        const Vector3<double>&L0 = start.angular_momentum_W, change = now.angular_momentum_W - L0;
        const double size = std::sqrt(dot(L0, L0)), energy_size = std::max(start.kinetic, std::abs(start.energy));
        found.t.push_back(s.t);
        found.energy.push_back(std::abs(now.energy - start.energy) / energy_size);
        found.momentum.push_back(std::sqrt(dot(change, change)) / size);
        found.momentum_length.push_back(
            std::abs(std::sqrt(dot(now.angular_momentum_W, now.angular_momentum_W)) - size) / size);
        found.momentum_z.push_back(std::abs(change[2]) / size);
        found.norm.push_back(std::abs(length - 1));
    }
    return found;
}

/// Checks that the exponent p of error ~ t^p is below 0.8. An error of a few roundings has no significant exponent.
void expect_no_bias(const Drift& found, const std::vector<double>& error, const char* what) {
    if (worst(error) < 4e-15) return;
    const auto growth = error_growth(found.t, error);
    ASSERT_TRUE(growth.has_value());
    EXPECT_LT(growth->exponent, 0.8) << what << " " << worst(error);
}

class Structure : public ::testing::TestWithParam<const char*> {};

std::string name_of_case(const ::testing::TestParamInfo<const char*>& info) { return info.param; }

constexpr const char* keep_momentum_and_energy[] = {"moser_veselov2",   "moser_veselov4",  "moser_veselov6",
                                                    "moser_veselov8",   "moser_veselov10", "splitting_exact2",
                                                    "splitting_exact8", "simo_wong"};
constexpr const char* keep_momentum[] = {"splitting2", "splitting4",       "splitting6",  "splitting8",
                                         "buss",       "commutator_free4", "munthe_kaas4"};

class KeepsMomentumAndEnergy : public Structure {};
TEST_P(KeepsMomentumAndEnergy, OfAFreeBodyToRoundOff) {
    for (const Scene& scene : {free_body(1), symmetric_body(1)}) {
        const Drift found = drift(scene, GetParam(), most_structure_steps, structure_step);
        EXPECT_LT(worst(found.norm), 1e-15);
        EXPECT_LT(worst(found.momentum), 2e-15);
        EXPECT_LT(worst(found.energy), 3e-14);
        expect_no_bias(found, found.energy, GetParam());
        RecordProperty("energy_" + scene.name.substr(0, 4), std::to_string(1e16 * worst(found.energy)) + "e-16");
    }
}
INSTANTIATE_TEST_SUITE_P(All, KeepsMomentumAndEnergy, ::testing::ValuesIn(keep_momentum_and_energy), name_of_case);

class KeepsMomentum : public Structure {};
TEST_P(KeepsMomentum, OfAFreeBodyToRoundOff) {
    // fewer steps for methods with many stages
    const long steps = find_method(GetParam())->order > 4 ? most_structure_steps / 4 : most_structure_steps;
    const Drift found = drift(free_body(1), GetParam(), steps, structure_step);
    EXPECT_LT(worst(found.norm), 1e-15);
    EXPECT_LT(worst(found.momentum), 2e-15);
}
INSTANTIATE_TEST_SUITE_P(All, KeepsMomentum, ::testing::ValuesIn(keep_momentum), name_of_case);

// The energy error of splitting is bounded: its maximum in the second half of the run is that of the first half.
TEST(Structure, SplittingsEnergyErrorStaysTheStepsOwn) {
    for (const char* method : {"splitting2", "splitting4", "splitting_exact2", "moser_veselov4"}) {
        const Drift found = drift(heavy_top(1), method, most_structure_steps / 4, 0.002);
        const auto middle = found.energy.begin() + static_cast<long>(found.energy.size() / 2);
        const double first = *std::max_element(found.energy.begin(), middle),
                     second = *std::max_element(middle, found.energy.end());
        EXPECT_GT(first, 1e-14) << method;
        EXPECT_LT(second, 1.2 * first) << method;
        EXPECT_LT(worst(found.momentum_z), 2e-15) << method;
        EXPECT_LT(worst(found.norm), 1e-15) << method;
    }
}

TEST(Structure, ImplicitMidpointKeepsQuadraticFormsAndNoOthers) {
    const Drift found = drift(free_body(1), "implicit_midpoint", most_structure_steps / 4, structure_step);
    EXPECT_LT(worst(found.norm), 1e-13);
    EXPECT_LT(worst(found.energy), 1e-13);
    EXPECT_LT(worst(found.momentum_length), 1e-13);
    EXPECT_GT(worst(found.momentum), 1e-6);
    Scene sprung = free_body(1);
    sprung.loads = {Spring{3, {0.8, 0.6, 0, 0}, {}}};
    for (const Scene& scene : {heavy_top(1), sprung}) {
        const Drift loaded = drift(scene, "implicit_midpoint", most_structure_steps / 10, 0.002);
        EXPECT_LT(worst(loaded.norm), 1e-13);
        EXPECT_LT(worst(loaded.energy), 1e-13);
    }
}

/// A symmetric step with -h reverses the step with h up to round-off.
TEST(Structure, FlowsAreSymmetric) {
    const Problem problem = pose(free_body(1));
    const Vector3<double> y(1, 2, 3);
    const auto expect_undone = [&](auto&& flow) {
        flow.prepare(y);
        RotationIncrement there, back;
        ASSERT_TRUE(flow.compute_rotation(y, 0.1, there));
        const Vector3<double> later =
            rotate_back(Quaternion<double>{1 + there.w, there.v[0], there.v[1], there.v[2]}, y);
        ASSERT_TRUE(flow.compute_rotation(later, -0.1, back));
        const RotationIncrement both = compose(there, back);
        EXPECT_LT(std::abs(both.w) + std::sqrt(dot(both.v, both.v)), 1e-15);
    };
    expect_undone(ThreeRotations(problem));
    expect_undone(ExactFreeMotion(problem));
    expect_undone(DiscreteMoserVeselov<1>(problem));
    expect_undone(DiscreteMoserVeselov<5>(problem));
}

/// Short steps use the Taylor series and long ones Jacobi's functions: two independent formulations of the same motion.
TEST(Structure, FreeMotionIsExactAtEveryStep) {
    Scene scene = free_body(1);
    for (const Vector3<double>& moments :
         {Vector3<double>(1, 2, 3), Vector3<double>(0.6, 0.8, 1), Vector3<double>(2, 2, 1),
          Vector3<double>(1, 1.0000001, 1.5), Vector3<double>(2, 2, 2)}) {
        scene.body.inertia_B = diagonal(moments);
        const Problem problem = pose(scene);
        const Vector3<double> w(1, -0.7, 0.4), y(moments[0] * w[0], moments[1] * w[1], moments[2] * w[2]);
        const auto form = ClosedForm<double>::find(moments, Forcing<double>{}, w, Quaternion<double>{}, 0);
        ASSERT_TRUE(form.has_value());
        for (double h = 1e-3; h < 300; h *= 2.7) {
            RotationIncrement d;
            ASSERT_TRUE(ExactFreeMotion(problem).compute_rotation(y, h, d));
            EXPECT_LT(rotation_angle_between({1 + d.w, d.v[0], d.v[1], d.v[2]}, form->at(h).q), 2e-15 * (4 + h));
        }
    }
}

/// The first terms printed in Hairer & Vilmart (2006): with C = |y|^2 / 2 and H the energy,
/// a_1 = -(1/I1 + 1/I2 + 1/I3) H / 3 + (I1 + I2 + I3) C / (6 I1 I2 I3),
/// b_1 = (I1 + I2 + I3) H / (6 I1 I2 I3) - C / (3 I1 I2 I3).
TEST(Structure, FirstModifiedMomentsAreThePublishedOnes) {
    const Vector3<double> I(0.6, 0.8, 1), y(1.8, 0.4, -0.9), r(1 / I[0], 1 / I[1], 1 / I[2]);
    const ModifiedMoments<5> found(r, y);
    const double C = dot(y, y) / 2, H = (r[0] * y[0] * y[0] + r[1] * y[1] * y[1] + r[2] * y[2] * y[2]) / 2;
    const double sum = I[0] + I[1] + I[2], product = I[0] * I[1] * I[2];
    EXPECT_NEAR(found.a(1), -(r[0] + r[1] + r[2]) * H / 3 + sum * C / (6 * product), 1e-14);
    EXPECT_NEAR(found.b(1), sum * H / (6 * product) - C / (3 * product), 1e-14);
}

/// The sum of g_i^k is 1 for k = 1 and 0 for odd k below the order: necessary conditions for symmetric compositions.
TEST(Structure, CompositionsMeetTheirOrderConditions) {
    for (const int order : {2, 4, 6, 8}) {
        const std::span<const double> g = composition(order);
        ASSERT_FALSE(g.empty());
        for (int k = 1; k < order; k += 2) {
            double sum = 0;
            for (std::size_t i = 0; i < g.size(); ++i) {
                sum += std::pow(g[i], k);
                EXPECT_EQ(g[i], g[g.size() - 1 - i]);
            }
            EXPECT_NEAR(sum, k == 1 ? 1 : 0, 1e-15) << order << " " << k;
        }
    }
    EXPECT_TRUE(composition(3).empty());
}

/// Under every load that a method supports it converges with its order to the same motion by another formulation.
TEST(Structure, AllLoadsOfASceneAtTheClaimedOrder) {
    for (const char* name : {"splitting2", "splitting4", "splitting6", "splitting_exact4", "moser_veselov6",
                             "munthe_kaas4", "commutator_free4", "implicit_midpoint"}) {
        const Scene scene = everything(1);
        const Quaternion<double> truth = with_tolerance(scene, "odeint_fehlberg78", 1e-14).samples.back().q;
        const Method& method = *find_method(name);
        const double h = method.order > 4 ? 1.0 / 16 : method.order > 2 ? 1.0 / 32 : 1.0 / 128;
        double coarse = 0, fine = 0;
        for (double* error : {&coarse, &fine}) {
            const Trajectory trajectory = with_step(scene, name, error == &coarse ? h : h / 2);
            ASSERT_EQ(trajectory.status, Status::ok) << name << trajectory.message;
            *error = attitude_error(trajectory.samples.back().q, truth);
        }
        EXPECT_NEAR(std::log2(coarse / fine), method.order, 0.5) << name << " " << coarse;
    }
}

/// Far too long steps and far too stiff loads end in bounded time, with a result or with a status and its reason.
TEST(Structure, ImpossibleStepsEndInANamedStatus) {
    Scene stiff = heavy_top(10);
    stiff.loads.push_back(Drag{{1e6, 1e6, 1e6}, 0, {}});
    for (const Method* method : methods()) {
        if (method->conserves.find("|q|") == std::string_view::npos || method->name.find("projected") < 99) continue;
        for (const Scene& scene : {free_body(1000), heavy_top(1000), stiff})
            for (const double h : {0.01, 1.0, 30.0}) {
                if (scene.duration / h > 2000) continue;
                const Trajectory trajectory = with_step(scene, method->name.data(), h);
                EXPECT_TRUE(trajectory.status == Status::ok || !trajectory.message.empty()) << method->name;
                for (const Sample& s : trajectory.samples) {
                    EXPECT_TRUE(std::isfinite(squared_norm(s.q))) << method->name;
                }
            }
    }
}

}  // namespace
}  // namespace polhode
