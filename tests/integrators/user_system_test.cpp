// User-defined systems, whose size is known only at run time.
#include "motion/user_system.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/math/special_functions/jacobi_elliptic.hpp>
#include <cmath>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "integrators/method.h"
#include "motion/systems.h"
#include "tests/integrators/scenes.h"

namespace polhode {
namespace {

/// n independent bodies in one system, each with the library's LoadedMotion.
struct SideBySide {
    std::shared_ptr<const std::vector<Problem>> alone;

    template <class Visit>
    void each(Visit&& visit) const {
        int first = 0;
        for (const Problem& problem : *alone) visit(LoadedMotion(problem), first), first += LoadedMotion::dimension;
    }
    int dimension() const { return static_cast<int>(alone->size()) * LoadedMotion::dimension; }
    void initial(double* y) const {
        each([&](const LoadedMotion& body, int first) { body.initial(y + first); });
    }
    template <class S>
    void derivative(const S* y, S* dy) const {
        each([&](const LoadedMotion& body, int first) { body.derivative(0, y + first, dy + first); });
    }
    std::vector<double> scales() const {
        std::vector<double> all(static_cast<std::size_t>(dimension()));
        each([&](const LoadedMotion& body, int first) { body.scales(all.data() + first); });
        return all;
    }
    std::vector<Sample> motion(const double* y) const {
        std::vector<Sample> bodies;
        each([&](const LoadedMotion& body, int first) { bodies.push_back(body.motion(0, y + first)); });
        return bodies;
    }
};

std::vector<Problem> three_bodies() {
    std::vector<Problem> problems;
    for (double spin : {0.5, 1.0, 1.5}) {
        Scene scene = testing::free_body(3);
        scene.initial.angular_velocity = {spin, 0.3, 1};
        scene.initial.velocity_W = {0.5, 0, spin};
        Drag drag;
        drag.rotational = {0.1, 0.2, 0.1}, drag.translational = 0.3;
        scene.loads = {drag};
        problems.push_back(pose(scene, Formulation::full_principal));
    }
    return problems;
}

double largest_difference(const Sample& a, const Sample& b) {
    const auto length = [](const Vector3<double>& v) { return std::sqrt(dot(v, v)); };
    return std::max({testing::attitude_error(a.q, b.q), length(a.angular_velocity_B - b.angular_velocity_B),
                     length(a.position_W - b.position_W), length(a.velocity_W - b.velocity_W)});
}

// An explicit method with fixed steps does the same to each body as alone: 300 steps of round-off on a state of size
// 1 give at most 300 x 1e-16. Implicit equations are solved to a thousandth of 1e-9. With a tolerance R each run errs
// by R per step, and these motions do not amplify errors.
TEST(ErasedSystem, BodiesSideBySideMoveAsEachDoesAlone) {
    const auto alone = std::make_shared<const std::vector<Problem>>(three_bodies());
    const Problem together = pose(SideBySide{alone}, 3);
    constexpr double R = 1e-9;
    int methods_run = 0;
    for (const Method* method : methods()) {
        if (!method->general_systems || !refusal(*method, together).empty()) continue;
        Settings settings;
        settings.samples = 3;
        if (takes_tolerance(*method))
            settings.tolerance = R;
        else
            settings.step = 0.01;
        const Trajectory all = solve(together, *method, settings);
        ASSERT_EQ(all.status, Status::ok) << method->name << ": " << all.message;
        ASSERT_EQ(all.bodies, 3);
        ASSERT_EQ(all.moments(), 4u);
        ++methods_run;
        double difference = 0;
        long steps = all.steps;
        for (std::size_t body = 0; body < alone->size(); ++body) {
            const Trajectory one = solve((*alone)[body], *method, settings);
            ASSERT_EQ(one.status, Status::ok) << method->name << ": " << one.message;
            steps = std::max(steps, all.steps + one.steps);
            for (std::size_t k = 0; k < 4; ++k) {
                EXPECT_EQ(all.at(k)[body].t, one.at(k)[0].t);
                difference = std::max(difference, largest_difference(all.at(k)[body], one.at(k)[0]));
            }
        }
        EXPECT_LT(difference, settings.step ? 1e-12 : R * static_cast<double>(std::max(steps, 100L))) << method->name;
    }
    EXPECT_GE(methods_run, 20);
}

TEST(ErasedSystem, AMethodThatNeedsTheBodySaysSo) {
    const auto alone = std::make_shared<const std::vector<Problem>>(three_bodies());
    const Trajectory trajectory = solve(pose(SideBySide{alone}, 3), *find_method("exact"));
    EXPECT_EQ(trajectory.status, Status::unsupported);
    EXPECT_NE(trajectory.message.find("supports only rigid bodies"), std::string::npos) << trajectory.message;
}

/// A mass on a spring, x'' = -x, with an impulse at t = 1.
struct StruckMass {
    double kick = 2;

    int dimension() const { return 2; }
    void initial(double* y) const { y[0] = 1, y[1] = 0; }
    template <class S>
    void derivative(const S* y, S* dy) const {
        dy[0] = y[1], dy[1] = -y[0];
    }
    std::vector<double> scales() const { return {1, 1}; }
    std::vector<double> events() const { return {1}; }
    void enter(double t, double* y) const {
        if (t == 1) y[1] += kick;
    }
    std::vector<Sample> motion(const double* y) const {
        Sample mass;
        mass.position_W = {y[0], 0, 0}, mass.velocity_W = {y[1], 0, 0};
        return {mass};
    }
};

// x = cos t, plus kick sin(t - 1) after t = 1. A sample at the event shows the motion after it.
TEST(ErasedSystem, EventsStrikeIt) {
    const Problem problem = pose(StruckMass(), 2.0);
    for (const char* name : {"cvode_adams", "cvode_bdf", "taylor", "radau", "dop853", "extrapolation"}) {
        Settings settings;
        settings.tolerance = 1e-9, settings.samples = 2;
        const Trajectory trajectory = solve(problem, *find_method(name), settings);
        ASSERT_EQ(trajectory.status, Status::ok) << name << ": " << trajectory.message;
        EXPECT_NEAR(trajectory.at(1)[0].velocity_W[0], -std::sin(1.0) + 2, 1e-7) << name;
        EXPECT_NEAR(trajectory.at(2)[0].position_W[0], std::cos(2.0) + 2 * std::sin(1.0), 1e-7) << name;
    }
}

/// A pendulum of length 1 m, state: angle from the lowest point and its rate, released at `amplitude`: a'' = -w^2 sin
/// a. Its body is a point at (sin a, -cos a); the first component of its velocity is the rate of the angle.
struct Pendulum {
    double rate = 3, amplitude = 2;

    int dimension() const { return 2; }
    void initial(double* y) const { y[0] = amplitude, y[1] = 0; }
    template <class S>
    void derivative(const S* y, S* dy) const {
        S s(0), c(0);
        sine_cosine(y[0], s, c);
        dy[0] = y[1], dy[1] = -(rate * rate) * s;
    }
    std::vector<double> scales() const { return {1, rate}; }
    std::vector<Sample> motion(const double* y) const {
        Sample bob;
        bob.position_W = {std::sin(y[0]), -std::cos(y[0]), 0}, bob.velocity_W = {y[1], 0, 0};
        return {bob};
    }
};

/// A planet about a sun with mu = 1 on an ellipse with semi-major axis 1, from the periapsis on: r'' = -r / |r|^3.
struct Planet {
    double eccentricity = 0.3;

    int dimension() const { return 4; }
    void initial(double* y) const {
        y[0] = 1 - eccentricity, y[1] = y[2] = 0, y[3] = std::sqrt((1 + eccentricity) / (1 - eccentricity));
    }
    template <class S>
    void derivative(const S* y, S* dy) const {
        const S square = y[0] * y[0] + y[1] * y[1], pull = -1.0 / (square * square_root(square));
        dy[0] = y[2], dy[1] = y[3], dy[2] = pull * y[0], dy[3] = pull * y[1];
    }
    std::vector<double> scales() const { return {1, 1, 1, 1}; }
    std::vector<Sample> motion(const double* y) const {
        Sample planet;
        planet.position_W = {y[0], y[1], 0}, planet.velocity_W = {y[2], y[3], 0};
        return {planet};
    }
};

template <class Model, class Expected>
void expect_closed_form(const Model& model, double duration, Expected&& expected) {
    const Problem problem = pose(model, duration);
    for (const char* name : {"taylor", "radau", "dop853", "extrapolation", "cvode_adams"})
        // 1e-7, 1e-10, 1e-13 and 1e-15 select the different orders of taylor
        for (const double tolerance : {1e-7, 1e-10, 1e-13, 1e-15}) {
            // a method with many small steps, each of which may err by the tolerance
            const bool multistep = std::string_view(name) == "cvode_adams";
            if (tolerance < 1e-13 && multistep) continue;
            Settings settings;
            settings.tolerance = tolerance, settings.samples = 5;
            const Trajectory trajectory = solve(problem, *find_method(name), settings);
            ASSERT_EQ(trajectory.status, Status::ok) << name << ": " << trajectory.message;
            for (std::size_t k = 0; k < trajectory.moments(); ++k) {
                const Sample& body = trajectory.at(k)[0];
                const auto [position, velocity] = expected(body.t);
                const double allowed = std::max((multistep ? 5000 : 500) * tolerance, 3e-13);
                for (int i = 0; i < 2; ++i) {
                    EXPECT_NEAR(body.position_W[i], position[i], allowed) << name << ' ' << tolerance;
                    EXPECT_NEAR(body.velocity_W[i], velocity[i], 3 * allowed) << name << ' ' << tolerance;
                }
            }
        }
}

// sin(a / 2) = k cd(w t, k), k = sin(amplitude / 2); a' = -2 w k k' sd(w t, k), because cd' = -k'^2 sd nd and
// cos(a / 2) = k' nd.
TEST(ErasedSystem, APendulumSwingsAsJacobisFunctionsSay) {
    const Pendulum pendulum;
    const double k = std::sin(pendulum.amplitude / 2), other = std::cos(pendulum.amplitude / 2);
    expect_closed_form(pendulum, 4, [&](double t) {
        const double u = pendulum.rate * t, sine = k * boost::math::jacobi_cd(k, u);
        const double cosine = std::sqrt((1 - sine) * (1 + sine));
        const double rate = -2 * pendulum.rate * k * other * boost::math::jacobi_sd(k, u);
        return std::pair(Vector3<double>(2 * sine * cosine, sine * sine - cosine * cosine, 0),
                         Vector3<double>(rate, 0, 0));
    });
}

// t = E - e sin E, r = (cos E - e, sqrt(1 - e^2) sin E)
TEST(ErasedSystem, APlanetObeysKepler) {
    const Planet planet;
    const double e = planet.eccentricity, b = std::sqrt(1 - e * e);
    expect_closed_form(planet, 10, [&](double t) {
        double E = t;
        for (int i = 0; i < 20; ++i) E -= (E - e * std::sin(E) - t) / (1 - e * std::cos(E));
        const double rate = 1 / (1 - e * std::cos(E));
        return std::pair(Vector3<double>(std::cos(E) - e, b * std::sin(E), 0),
                         Vector3<double>(-std::sin(E) * rate, b * std::cos(E) * rate, 0));
    });
}

TEST(ErasedSystem, RefusesInconsistentSystems) {
    EXPECT_THROW(pose(StruckMass(), 0.0), InputError);
    EXPECT_THROW(pose(StruckMass(), std::nan("")), InputError);
}

}  // namespace
}  // namespace polhode
