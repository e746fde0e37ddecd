// A trial of check: a game engine of sixty lines with 33 different faults, whose files the program checks. The engine
// does not use polhode: arrays, world axes, one row per step.
#include <array>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "app/program_fixture.h"
#include "build_kind.h"

namespace polhode {
namespace {

using Triple = std::array<double, 3>;
using Turn = std::array<double, 4>;  // w, x, y, z

Turn turn_product(const Turn& a, const Turn& b) {
    return {
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3], a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1], a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
}
Triple turn_of(const Turn& q, const Triple& v, bool back = false) {
    const double s = back ? -1 : 1;
    const Turn p = turn_product(turn_product({q[0], s * q[1], s * q[2], s * q[3]}, {0, v[0], v[1], v[2]}),
                                {q[0], -s * q[1], -s * q[2], -s * q[3]});
    return {p[1], p[2], p[3]};
}

// The engine's body and its switches. A fault changes one of them.
struct SmallEngine {
    Triple moments, rate_B, position{}, velocity{}, gravity{};
    double gyroscopic = 1, turn_by = 1, clock = 1, damping = 0, kept_a_step = 1, fastest = 1e9, sleeps_at = 1e9;
    double linear_damping = 0, gravity_by = 1;
    bool turn_on_the_left = false, frozen = false;
    Turn q{1, 0, 0, 0};

    void step(double t, double h) {
        if (t >= sleeps_at) return;
        h *= clock;
        const Triple L{moments[0] * rate_B[0], moments[1] * rate_B[1], moments[2] * rate_B[2]}, w = rate_B;
        for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
            rate_B[i] =
                (w[i] - h * gyroscopic * (w[j] * L[k] - w[k] * L[j]) / moments[i]) * (1 - damping * h) * kept_a_step;
            velocity[i] = (velocity[i] + h * gravity_by * gravity[i]) * (1 - linear_damping * h);
            position[i] += h * velocity[i];
        }
        const double speed = std::sqrt(rate_B[0] * rate_B[0] + rate_B[1] * rate_B[1] + rate_B[2] * rate_B[2]);
        if (speed > fastest)
            for (double& x : rate_B) x *= fastest / speed;
        if (frozen || speed == 0) return;
        const double now = std::min(speed, fastest), half = turn_by * h * now / 2, s = std::sin(half) / now;
        const Turn by{std::cos(half), s * rate_B[0], s * rate_B[1], s * rate_B[2]};
        q = turn_on_the_left ? turn_product(by, q) : turn_product(q, by);
    }
};

struct Row {
    double t;
    Turn q;
    Triple w, p, v;
};

struct Break {
    const char* name;
    const char* scene;
    const char* told;                                                         // the expected diagnosis
    void (*engine)(SmallEngine&) = [](SmallEngine&) {};                       // fault in the engine
    void (*row)(Row&, const SmallEngine&) = [](Row&, const SmallEngine&) {};  // or in its output
};

constexpr double circle = 6.283185307179586;
void scale_triple(Triple& v, double by) {
    for (double& x : v) x *= by;
}
void mirror(Row& r, std::size_t a, std::size_t b) {
    // exchanges axes a and b: the handedness and the sense of every rotation change
    std::swap(r.q[1 + a], r.q[1 + b]), std::swap(r.w[a], r.w[b]), std::swap(r.p[a], r.p[b]), std::swap(r.v[a], r.v[b]);
    for (std::size_t i = 0; i < 3; ++i) r.q[1 + i] = -r.q[1 + i], r.w[i] = -r.w[i];
}

using E = SmallEngine;
const Break breaks[] = {
    {"NoGyroscopicTerm", "t_handle", "gyroscopic_term_missing", [](E& e) { e.gyroscopic = 0; }},
    {"GyroscopicTermReversed", "t_handle", "gyroscopic_term_reversed", [](E& e) { e.gyroscopic = -1; }},
    {"MomentsXYExchanged", "t_handle", "inertia_axes_permuted", [](E& e) { std::swap(e.moments[0], e.moments[1]); }},
    {"MomentsYZExchanged", "t_handle", "inertia_axes_permuted", [](E& e) { std::swap(e.moments[1], e.moments[2]); }},
    {"MomentsRolled", "t_handle", "inertia_axes_permuted",
     [](E& e) {
         e.moments = {e.moments[1], e.moments[2], e.moments[0]};
     }},
    {"StartInDegrees", "free_asymmetric", "degrees_for_radians", [](E& e) { scale_triple(e.rate_B, circle / 360); }},
    {"StartInRpm", "free_asymmetric", "rpm_for_radians", [](E& e) { scale_triple(e.rate_B, circle / 60); }},
    {"HalfRate", "t_handle", "attitude_turned_at_half_rate", [](E& e) { e.turn_by = 0.5; }},
    {"TwiceTheRate", "t_handle", "attitude_turned_at_twice_the_rate", [](E& e) { e.turn_by = 2; }},
    {"TurnedBackwards", "t_handle", "attitude_turned_backwards", [](E& e) { e.turn_by = -1; }},
    {"TurnedOnTheLeft", "t_handle", "body_rate_multiplied_on_the_left", [](E& e) { e.turn_on_the_left = true; }},
    {"NeverTurns", "t_handle", "rotation_frozen", [](E& e) { e.frozen = true; }},
    {"NothingMoves", "free_asymmetric", "motion_stopped", [](E& e) { e.sleeps_at = 0; }},
    {"FallsAsleep", "thrown_hammer", "motion_stopped", [](E& e) { e.sleeps_at = 0.4; }},
    {"DampingASecond", "free_asymmetric", "damping_left_on", [](E& e) { e.damping = 0.1; }},
    {"DampingAStep", "free_asymmetric", "damping_left_on", [](E& e) { e.kept_a_step = 0.998; }},
    {"SpeedClamped", "t_handle", "speed_clamped", [](E& e) { e.fastest = 7; }},
    {"FixedStepOnAnotherClock", "t_handle", "wrong_time_step", [](E& e) { e.clock = 1.2; }},
    {"ClockTooSlow", "thrown_hammer", "wrong_time_step", [](E& e) { e.clock = 0.5; }},
    {"LinearDamping", "thrown_hammer", "linear_damping_left_on", [](E& e) { e.linear_damping = 0.3; }},
    {"GravityReversed", "thrown_hammer", "gravity_reversed", [](E& e) { e.gravity_by = -1; }},
    {"GravityMissing", "thrown_hammer", "gravity_missing", [](E& e) { e.gravity_by = 0; }},
    {"GravityTwice", "thrown_hammer", "gravity_twice", [](E& e) { e.gravity_by = 2; }},
    {"Inverted", "t_handle", "inverted_orientation", {}, [](Row& r, const E&) { r.q[0] = -r.q[0]; }},
    {"ScalarLast",
     "t_handle",
     "scalar_last_quaternion",
     {},
     [](Row& r, const E&) {
         r.q = {r.q[1], r.q[2], r.q[3], r.q[0]};
     }},
    {"RatesInBodyAxes", "t_handle", "angular_velocity_in_body_axes", {}, [](Row& r, const E& e) { r.w = e.rate_B; }},
    {"RatesInDegrees",
     "t_handle",
     "angular_velocity_in_degrees",
     {},
     [](Row& r, const E&) { scale_triple(r.w, 360 / circle); }},
    {"RatesInRpm", "t_handle", "angular_velocity_in_rpm", {}, [](Row& r, const E&) { scale_triple(r.w, 60 / circle); }},
    {"RatesNegated", "t_handle", "angular_velocity_negated", {}, [](Row& r, const E&) { scale_triple(r.w, -1); }},
    {"YUpLeftHanded", "thrown_hammer", "other_axes", {}, [](Row& r, const E&) { mirror(r, 1, 2); }},
    {"Centimetres",
     "thrown_hammer",
     "lengths_in_centimetres",
     {},
     [](Row& r, const E&) { scale_triple(r.p, 100), scale_triple(r.v, 100); }},
    {"Inches",
     "thrown_hammer",
     "lengths_in_inches",
     {},
     [](Row& r, const E&) { scale_triple(r.p, 1 / 0.0254), scale_triple(r.v, 1 / 0.0254); }},
    {"OriginForCenterOfMass",
     "thrown_hammer",
     "origin_for_center_of_mass",
     {},
     [](Row& r, const E& e) {
         // the origin is 0.297 m below the centre, body axes; it moves with v + w x r
         const Triple arm = turn_of(e.q, {0, 0, -0.297}), w = r.w;
         for (std::size_t i = 0; i < 3; ++i) {
             const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
             r.p[i] += arm[i], r.v[i] += w[j] * arm[k] - w[k] * arm[j];
         }
     }},
};

SmallEngine engine_on(const std::string& scene) {
    if (scene == "t_handle") return {.moments = {2.2375e-4, 3.75e-4, 5.7625e-4}, .rate_B = {0.01, 15, 0.02}};
    if (scene == "free_asymmetric") return {.moments = {1, 2, 3}, .rate_B = {1, 1, 1}};
    return {.moments = {0.0135504, 0.0142254, 0.0007938},
            .rate_B = {12, 0.3, 0.2},
            .position = {0, 0, 1.5},
            .velocity = {2, 0, 4},
            .gravity = {0, 0, -9.80665}};
}

struct Rate {
    const char* name;
    int hertz, substeps;
};
constexpr Rate rates[] = {{"At60Hz", 60, 1}, {"At240Hz", 240, 1}, {"NearExact", 60, 64}};

class SmallEngineFile : public Program {
  protected:
    // Writes two seconds of the faulty engine (one for thrown_hammer) and checks them.
    nlohmann::json judged(const std::string& scene, const Rate& rate, const Break* broken, int& exit_code) const {
        SmallEngine engine = engine_on(scene);
        if (broken && broken->engine) broken->engine(engine);
        std::FILE* const file = std::fopen((directory / "engine.csv").c_str(), "w");
        std::fputs("t,qw,qx,qy,qz,wx,wy,wz,px,py,pz,vx,vy,vz\n", file);
        const int rows = scene == "thrown_hammer" ? rate.hertz : 2 * rate.hertz;
        for (int n = 0; n <= rows; ++n) {
            Row r{static_cast<double>(n) / rate.hertz, engine.q, turn_of(engine.q, engine.rate_B), engine.position,
                  engine.velocity};
            if (broken && broken->row) broken->row(r, engine);
            std::fprintf(file, "%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\n",
                         r.t, r.q[0], r.q[1], r.q[2], r.q[3], r.w[0], r.w[1], r.w[2], r.p[0], r.p[1], r.p[2], r.v[0],
                         r.v[1], r.v[2]);
            const double h = 1.0 / rate.hertz / rate.substeps;
            for (int i = 0; i < rate.substeps; ++i) engine.step(r.t + i * h, h);
        }
        std::fclose(file);
        const Outcome outcome = run({"check", scene, "engine.csv", "--format", "json"});
        exit_code = outcome.exit_code;
        return nlohmann::json::parse(outcome.out)["trajectories"][0];
    }
};

class Trial : public SmallEngineFile, public testing::WithParamInterface<std::tuple<Rate, const Break*>> {};

TEST_P(Trial, ReportsTheFault) {
    const auto& [rate, broken] = GetParam();
    int exit_code = 0;
    const nlohmann::json report = judged(broken->scene, rate, broken, exit_code);
    EXPECT_EQ(exit_code, 1);
    std::string told;
    for (const auto& diagnosis : report["diagnoses"]) told += diagnosis["fault"].get<std::string>() + " ";
    EXPECT_NE(told.find(broken->told), std::string::npos) << told << report.dump(1);
}
std::vector<const Break*> some_breaks() {
    std::vector<const Break*> some;
    for (std::size_t i = 0; i < std::size(breaks); i += optimised_build ? 1 : 11) some.push_back(&breaks[i]);
    return some;
}
INSTANTIATE_TEST_SUITE_P(Files, Trial, testing::Combine(testing::ValuesIn(rates), testing::ValuesIn(some_breaks())),
                         [](const auto& one) {
                             return std::string(std::get<1>(one.param)->name) + std::get<0>(one.param).name;
                         });

TEST_F(SmallEngineFile, ReportsNoFaultOfACorrectEngine) {
    for (const char* scene : {"t_handle", "free_asymmetric", "thrown_hammer"})
        for (const Rate& rate : rates) {
            int exit_code = 0;
            const nlohmann::json report = judged(scene, rate, nullptr, exit_code);
            EXPECT_TRUE(report["diagnoses"].empty()) << scene << rate.name << report.dump(1);
        }
}

}  // namespace
}  // namespace polhode
