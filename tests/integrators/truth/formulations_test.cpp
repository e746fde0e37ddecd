// The two formulations against each other on random bodies under every load, and collocation against Taylor series.
#include <gtest/gtest.h>

#include <cmath>

#include "integrators/truth/attempt.h"
#include "integrators/truth/euler_form.h"
#include "integrators/truth/fresh_cache.h"
#include "integrators/truth/loaded_scene.h"
#include "integrators/truth/momentum_form.h"
#include "integrators/truth/reference.h"

namespace polhode {
namespace {

double largest(const Vector3<double>& v) { return std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])}); }

TEST(Formulations, HaveTheSameRatesInDouble) {
    for (unsigned seed = 0; seed < 300; ++seed) {
        const Scene scene = loaded_scene(seed, seed % 2 == 0);
        truth::EulerForm<double> euler(scene);
        truth::MomentumForm<double> momentum(scene);
        double y[13] = {}, z[13] = {}, dy[13] = {}, dz[13] = {};
        euler.initial(y), momentum.initial(z);
        // all loads act, after the impulses
        euler.enter(0.5, y), momentum.enter(0.5, z);
        const truth::Motion<double> a = euler.motion(y), b = momentum.motion(z);
        // a few hundred operations on numbers up to 100, 1e-15 each; condition number of the inertia up to 100
        EXPECT_LT(largest(a.angular_velocity_B - b.angular_velocity_B), 1e-10) << seed;
        EXPECT_LT(largest(a.velocity_W - b.velocity_W), 1e-10) << seed;
        euler.derivative(y, dy), momentum.derivative(z, dz);
        // dL/dt = R (I dw/dt + w x I w)
        const Matrix3<double> inertia = exact_body<double>(scene).inertia_B;
        const Vector3<double> w = a.angular_velocity_B;
        const Vector3<double> L_rate = rotate(a.q, inertia * vector_at(dy, 0) + cross(w, inertia * w));
        EXPECT_LT(largest(L_rate - vector_at(dz, 0)), 1e-10) << seed;
        for (int i = 3; i < 7; ++i) EXPECT_NEAR(dy[i], dz[i], 1e-10) << seed;
        if (scene.pivot) continue;
        EXPECT_LT(largest(vector_at(dy, 7) - vector_at(dz, 7)), 1e-10) << seed;
        EXPECT_LT(largest(scene.body.mass * vector_at(dy, 10) - vector_at(dz, 10)), 1e-10) << seed;
    }
}

TEST(Formulations, AgreeTo25DigitsUnderEveryLoad) {
    const FreshCache cache;
    for (unsigned seed = 0; seed < 6; ++seed) {
        const Reference truth = reference(loaded_scene(seed, seed % 2 == 0), 8);
        EXPECT_TRUE(truth.available) << seed << ": " << truth.message;
        EXPECT_LE(truth.bound, 1e-25);
        EXPECT_GT(truth.bound, 0);
    }
}

double difference(const truth::Truth& a, const truth::Truth& b) {
    double worst = 0;
    const auto note = [&](const Pair& x, const Pair& y) {
        worst = std::max(worst, std::abs((x.high - y.high) + (x.low - y.low)));
    };
    for (std::size_t k = 0; k < a.reference.samples.size(); ++k) {
        const ReferenceSample &x = a.reference.samples[k], &y = b.reference.samples[k];
        note(x.q.w, y.q.w), note(x.q.x, y.q.x), note(x.q.y, y.q.y), note(x.q.z, y.q.z);
        for (int i = 0; i < 3; ++i) {
            note(x.angular_velocity_B[i], y.angular_velocity_B[i]);
            note(x.position_W[i], y.position_W[i]);
            note(x.velocity_W[i], y.velocity_W[i]);
        }
    }
    return worst;
}

TEST(Formulations, CollocationAgreesWithTaylorSeries) {
    for (const bool pivoted : {true, false}) {
        Scene scene = loaded_scene(7, pivoted);
        scene.loads.push_back(Drag{{60, 80, 100}, 50, {}});
        const Problem problem = pose(scene);
        const std::vector<double> times{0, 0.0625, 0.5, 0.625, 1};
        const truth::Attempt series = truth::attempt_by_taylor<50>(problem, times, 33);
        const truth::Attempt implicit = truth::attempt_by_collocation<50>(problem, times, 33);
        ASSERT_TRUE(series.fault.empty() && implicit.fault.empty()) << series.fault << implicit.fault;
        EXPECT_GE(series.agreed_digits, 25);
        EXPECT_GE(implicit.agreed_digits, 25);
        // both promise 25 digits of numbers up to 10
        EXPECT_LT(difference(series.truth, implicit.truth), 1e-24);
    }
}

TEST(Formulations, StiffSceneIsDoneByCollocation) {
    // stiff relaxation under a torque: w about z tends to torque / drag = 0.5 at the rate 10^6 / 2
    Scene scene;
    scene.name = "stiff";
    scene.duration = 100;
    scene.body.inertia_B = diagonal(Vector3<double>(1, 1.5, 2));
    scene.initial.angular_velocity = {0, 0, 1};
    scene.loads.push_back(Drag{{1e6, 1e6, 1e6}, 0, {}});
    scene.loads.push_back(Torque{{0, 0, 5e5}, Frame::body, {}});
    const FreshCache cache;
    const Reference truth = reference(scene, 4);
    ASSERT_TRUE(truth.available) << truth.message;
    EXPECT_NE(truth.message.find("Radau"), std::string::npos);
    // angle = t / 2 + 0.5 (1 - e^(-t 10^6 / 2)) 2e-6, and the exponential is 0 in binary64 at t = 25
    for (int k = 1; k <= 4; ++k) {
        EXPECT_NEAR(truth.samples[k].angular_velocity_B[2].high, 0.5, 1e-16);
        EXPECT_NEAR(truth.samples[k].q.w.high, std::cos((truth.samples[k].t / 2 + 1e-6) / 2), 1e-14);
    }
}

}  // namespace
}  // namespace polhode
