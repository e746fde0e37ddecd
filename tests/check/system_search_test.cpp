// Faults of engines with several bodies. The engine is a planar double pendulum by the textbook equations for its two
// angles, which share no code with the predictions of `check`. It has one fault at a time.
#include "check/system_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "build_kind.h"
#include "check/file_errors.h"
#include "motion/trajectory_csv.h"

namespace polhode {
namespace {

// m and kg; the hinges are about y, and angles are measured from the hanging position
constexpr double length_of_upper = 0.8, upper_center = 0.45, lower_center = 0.3, upper_mass = 1.5, lower_mass = 0.7,
                 upper_moment = 0.09, lower_moment = 0.04, gravity = 9.81, shoulder_damping = 0.2,
                 elbow_stiffness = 1.2, elbow_rest = 0.3, shoulder_motor = 1.1;

Scene double_pendulum() {
    Scene scene;
    scene.name = "double pendulum", scene.duration = 3;
    scene.bodies.resize(2);
    const auto give = [](NamedBody& body, const char* name, double mass, double moment, double center) {
        body.name = name, body.body.mass = mass, body.body.center_of_mass = {0, 0, -center};
        body.body.inertia_B = diagonal(Vector3<double>(moment, moment, 0.2 * moment));
    };
    give(scene.bodies[0], "upper", upper_mass, upper_moment, upper_center);
    give(scene.bodies[1], "lower", lower_mass, lower_moment, lower_center);
    scene.joints.resize(2);
    Joint &shoulder = scene.joints[0], &elbow = scene.joints[1];
    shoulder.name = "shoulder", shoulder.child = "upper", shoulder.axes[0] = {0, 1, 0};
    shoulder.coordinate[0] = 0.9, shoulder.rate[0] = 1, shoulder.damping[0] = shoulder_damping;
    elbow.name = "elbow", elbow.parent = "upper", elbow.child = "lower", elbow.axes[0] = {0, 1, 0};
    elbow.parent_point = {0, 0, -length_of_upper};
    elbow.coordinate[0] = -0.4, elbow.rate[0] = 2, elbow.stiffness[0] = elbow_stiffness, elbow.rest[0] = elbow_rest;
    scene.loads = {Gravity{{0, 0, -gravity}, {}}, Motor{"shoulder", shoulder_motor, {}}};
    return scene;
}

// Faults and step of the engine.
struct PendulumFaults {
    double gravity_on_upper = 1, gravity_on_lower = 1, damping = 1, stiffness = 1, motor = 1, lower_mass = 1,
           lower_moment = 1, length = 1;
    double elbow_damping = 0, elbow_friction = 0;  // N m s, N m
    double elbow_limit = HUGE_VAL;                 // rad
    bool runge_kutta = false;
    int substeps = 1;
};

class Pendulum {
  public:
    explicit Pendulum(const PendulumFaults& knobs) : k_(knobs) {}

    void advance(double h) {
        for (int i = 0; i < k_.substeps; ++i) step(h / k_.substeps);
    }
    void add_rows(double t, TrajectoryFile& file) const {
        const double length = k_.length * length_of_upper;
        const auto at = [](double angle, double distance) {
            return Vector3<double>(-distance * std::sin(angle), 0, -distance * std::cos(angle));
        };
        const auto rate_at = [](double angle, double rate, double distance) {
            return Vector3<double>(-distance * std::cos(angle) * rate, 0, distance * std::sin(angle) * rate);
        };
        const auto add = [&](double angle, double rate, const Vector3<double>& p, const Vector3<double>& v) {
            file.rows.push_back({t, {std::cos(angle / 2), 0, std::sin(angle / 2), 0}, {0, rate, 0}, p, v});
        };
        add(x_[0], u_[0], at(x_[0], upper_center), rate_at(x_[0], u_[0], upper_center));
        add(x_[1], u_[1], at(x_[0], length) + at(x_[1], lower_center),
            rate_at(x_[0], u_[0], length) + rate_at(x_[1], u_[1], lower_center));
    }

  private:
    using Pair = std::array<double, 2>;
    PendulumFaults k_;
    Pair x_{0.9, 0.5}, u_{1, 3};  // angle and rate of each bar relative to the world

    // Returns M^-1 r.
    Pair solved(const Pair& x, const Pair& r) const {
        const double m = k_.lower_mass * lower_mass, l = k_.length * length_of_upper;
        const double a = upper_moment + upper_mass * upper_center * upper_center + m * l * l,
                     b = m * l * lower_center * std::cos(x[0] - x[1]),
                     c = k_.lower_moment * lower_moment + m * lower_center * lower_center;
        const double d = a * c - b * b;
        return {(c * r[0] - b * r[1]) / d, (a * r[1] - b * r[0]) / d};
    }
    Pair acceleration(const Pair& x, const Pair& u) const {
        const double m = k_.lower_mass * lower_mass, l = k_.length * length_of_upper;
        const double turn = x[1] - x[0], rate = u[1] - u[0], s = m * l * lower_center * std::sin(x[0] - x[1]);
        const double shoulder = k_.motor * shoulder_motor - k_.damping * shoulder_damping * u[0];
        const double elbow = -k_.stiffness * elbow_stiffness * (turn - elbow_rest) - k_.elbow_damping * rate -
                             (rate > 0   ? k_.elbow_friction
                              : rate < 0 ? -k_.elbow_friction
                                         : 0);
        const double g1 = k_.gravity_on_upper * upper_mass * upper_center, g2 = k_.gravity_on_lower * m;
        return solved(x, {shoulder - elbow - s * u[1] * u[1] - (g1 + g2 * l) * gravity * std::sin(x[0]),
                          elbow + s * u[0] * u[0] - g2 * lower_center * gravity * std::sin(x[1])});
    }
    void step(double h) {
        if (k_.runge_kutta) {
            const auto on = [](const Pair& a, double by, const Pair& b) {
                return Pair{a[0] + by * b[0], a[1] + by * b[1]};
            };
            const Pair a1 = acceleration(x_, u_), v1 = u_;
            const Pair v2 = on(u_, h / 2, a1), a2 = acceleration(on(x_, h / 2, v1), v2);
            const Pair v3 = on(u_, h / 2, a2), a3 = acceleration(on(x_, h / 2, v2), v3);
            const Pair v4 = on(u_, h, a3), a4 = acceleration(on(x_, h, v3), v4);
            for (std::size_t i = 0; i < 2; ++i) {
                x_[i] += h / 6 * (v1[i] + 2 * (v2[i] + v3[i]) + v4[i]);
                u_[i] += h / 6 * (a1[i] + 2 * (a2[i] + a3[i]) + a4[i]);
            }
        } else {
            const Pair a = acceleration(x_, u_);
            for (std::size_t i = 0; i < 2; ++i) u_[i] += h * a[i];
            for (std::size_t i = 0; i < 2; ++i) x_[i] += h * u_[i];
        }
        // the elbow's limit: an impulse at the joint that makes its rate zero
        const double rate = u_[1] - u_[0];
        if (x_[1] - x_[0] > k_.elbow_limit && rate > 0) {
            const Pair change = solved(x_, {-1, 1});
            const double size = -rate / (change[1] - change[0]);
            u_[0] += size * change[0], u_[1] += size * change[1];
        }
    }
};

TrajectoryFile recorded(const PendulumFaults& knobs, double hertz) {
    TrajectoryFile file;
    file.bodies = {"upper", "lower"};
    file.has_angular_velocity = file.has_position = file.has_velocity = true;
    Pendulum pendulum(knobs);
    for (int k = 0; k <= static_cast<int>(2.5 * hertz); ++k) {
        if (k > 0) pendulum.advance(1 / hertz);
        pendulum.add_rows(k / hertz, file);
    }
    return file;
}

struct BrokenCase {
    const char* name;
    void (*broken)(PendulumFaults&);
    std::vector<std::string> words;  // correct diagnoses
    const char* message_part;        // part of the message
};
const std::vector<BrokenCase> cases{
    {"damping missing", [](PendulumFaults& k) { k.damping = 0; }, {"joint_damping_missing"}, "\"shoulder\""},
    {"damping tripled", [](PendulumFaults& k) { k.damping = 3; }, {"joint_damping_scaled"}, "\"shoulder\" is 3 times"},
    {"damping left on",
     [](PendulumFaults& k) { k.elbow_damping = 0.05; },
     {"joint_damping_left_on"},
     "\"elbow\" is left on: 0.05 N m s"},
    {"friction",
     [](PendulumFaults& k) { k.elbow_friction = 0.25; },
     {"joint_friction_left_on"},
     "friction of joint \"elbow\""},
    {"spring scaled", [](PendulumFaults& k) { k.stiffness = 1.6; }, {"joint_spring_scaled"}, "1.6 times"},
    {"spring missing", [](PendulumFaults& k) { k.stiffness = 0; }, {"joint_spring_missing"}, "\"elbow\""},
    {"spring reversed", [](PendulumFaults& k) { k.stiffness = -1; }, {"joint_spring_reversed"}, "\"elbow\""},
    {"motor missing", [](PendulumFaults& k) { k.motor = 0; }, {"motor_missing"}, "\"shoulder\""},
    {"motor reversed", [](PendulumFaults& k) { k.motor = -1; }, {"motor_reversed"}, "\"shoulder\""},
    {"motor scaled", [](PendulumFaults& k) { k.motor = 0.35; }, {"motor_scaled"}, "0.35 times"},
    {"gravity missing",
     [](PendulumFaults& k) { k.gravity_on_upper = k.gravity_on_lower = 0; },
     {"gravity_missing"},
     ""},
    {"gravity scaled",
     [](PendulumFaults& k) { k.gravity_on_upper = k.gravity_on_lower = 0.9; },
     {"gravity_scaled"},
     "0.9 times"},
    {"weightless forearm", [](PendulumFaults& k) { k.gravity_on_lower = 0; }, {"gravity_on_body_missing"}, "\"lower\""},
    {"mass", [](PendulumFaults& k) { k.lower_mass = 1.3; }, {"body_mass_scaled"}, "\"lower\" is 1.3 times"},
    {"inertia", [](PendulumFaults& k) { k.lower_moment = 2.5; }, {"body_inertia_scaled"}, "\"lower\" is 2.5 times"},
    {"density",
     [](PendulumFaults& k) { k.lower_mass = k.lower_moment = 0.6; },
     {"body_density_scaled"},
     "\"lower\" is 0.6 times"},
    {"elbow elsewhere", [](PendulumFaults& k) { k.length = 1.05; }, {"joint_anchor_off"}, "\"elbow\""},
    {"elbow limited",
     [](PendulumFaults& k) { k.elbow_limit = 0.6; },
     {"joint_limit_where_none"},
     "\"elbow\" is stopped at 0.6"},
};

class SystemFault : public ::testing::TestWithParam<std::size_t> {};

std::string describe_faults(const std::vector<Diagnosis>& faults) {
    std::string all;
    for (const Diagnosis& d : faults) all += d.fault + ": " + d.message + "\n";
    return all;
}

TEST_P(SystemFault, IsNamedAtEveryRate) {
    const BrokenCase& one = cases[GetParam()];
    const Scene scene = double_pendulum();
    for (const double hertz : {60.0, 240.0, 1000.0})
        for (const int way : {0, 1, 2}) {
            // one way is sufficient for many rows
            if (!optimised_build && (hertz > 60 || way != 0)) continue;
            if (hertz > 500 && way != static_cast<int>(GetParam() % 3)) continue;
            PendulumFaults knobs;
            one.broken(knobs);
            knobs.runge_kutta = way == 1, knobs.substeps = way == 2 ? 4 : 1;
            // within a row of 1/60 s a limit looks like the reversal of a swing
            if (hertz < 100 && std::isfinite(knobs.elbow_limit)) continue;
            const std::vector<Diagnosis> found = diagnose_system(scene, recorded(knobs, hertz)).faults;
            ASSERT_FALSE(found.empty()) << one.name << " at " << hertz << " Hz, way " << way;
            EXPECT_TRUE(std::ranges::any_of(found,
                                            [&](const Diagnosis& d) {
                                                return std::ranges::find(one.words, d.fault) != one.words.end() &&
                                                       d.message.find(one.message_part) != std::string::npos;
                                            }))
                << one.name << " at " << hertz << " Hz, way " << way << "\n"
                << describe_faults(found);
        }
}
INSTANTIATE_TEST_SUITE_P(Of, SystemFault, ::testing::Range(std::size_t{0}, cases.size()));

TEST(SystemSearch, ReportsNoFaultOfACorrectEngine) {
    const Scene scene = double_pendulum();
    for (const double hertz : {30.0, 60.0, 240.0, 1000.0})
        for (const int way : {0, 1, 2}) {
            if (!optimised_build && (hertz != 60 || way != 0)) continue;
            PendulumFaults knobs;
            knobs.runge_kutta = way == 1, knobs.substeps = way == 2 ? 4 : 1;
            const std::vector<Diagnosis> found = diagnose_system(scene, recorded(knobs, hertz)).faults;
            EXPECT_TRUE(found.empty()) << hertz << " Hz, way " << way << "\n" << describe_faults(found);
        }
}

TEST(SystemSearch, FollowsFromAttitudesAloneWhereJointsTieAllBodies) {
    const Scene scene = double_pendulum();
    PendulumFaults knobs;
    knobs.runge_kutta = true, knobs.stiffness = 0;
    TrajectoryFile file = recorded(knobs, 240);
    for (TrajectoryRow& row : file.rows) row.position_W = row.velocity_W = row.angular_velocity_W = {};
    file.has_position = file.has_velocity = file.has_angular_velocity = false;
    const std::vector<Diagnosis> found = diagnose_system(scene, file).faults;
    ASSERT_FALSE(found.empty());
    EXPECT_EQ(found.front().fault, "joint_spring_missing");
}

TEST(SystemSearch, TwoFaultsAreBothNamed) {
    const Scene scene = double_pendulum();
    PendulumFaults knobs;
    knobs.motor = 0, knobs.gravity_on_upper = knobs.gravity_on_lower = 0.8;
    const std::vector<Diagnosis> found = diagnose_system(scene, recorded(knobs, 240)).faults;
    ASSERT_EQ(found.size(), 2u) << describe_faults(found);
    const auto has = [&](const char* word) {
        return std::ranges::any_of(found, [&](const Diagnosis& d) { return d.fault == word; });
    };
    EXPECT_TRUE(has("motor_missing") && has("gravity_scaled")) << describe_faults(found);
}

TEST(SystemSearch, ReportsWronglyReadColumns) {
    const Scene scene = double_pendulum();
    const TrajectoryFile sound = recorded({}, 240);
    const auto first = [&](const TrajectoryFile& file) {
        const std::vector<Diagnosis> found = diagnose_system(scene, file).faults;
        return found.empty() ? std::string() : found.front().fault;
    };
    TrajectoryFile file = sound;
    for (TrajectoryRow& row : file.rows) row.angular_velocity_W = (180 / std::acos(-1.0)) * row.angular_velocity_W;
    EXPECT_EQ(first(file), "angular_velocity_in_degrees");
    file = sound;
    for (TrajectoryRow& row : file.rows)
        row.position_W = 100.0 * row.position_W, row.velocity_W = 100.0 * row.velocity_W;
    EXPECT_EQ(first(file), "lengths_in_centimetres");
    file = sound;
    for (std::size_t i = 0; i < file.rows.size(); ++i) {
        TrajectoryRow& row = file.rows[i];
        row.position_W = row.position_W - rotation_matrix(row.q) * scene.bodies[i % 2].body.center_of_mass;
    }
    EXPECT_EQ(first(file), "origin_for_center_of_mass");
}

TEST(SystemSearch, BaumgartesPullIsMeasured) {
    // the anchor of the lower bar is displaced and is pulled back at 12 1/s
    const Scene scene = double_pendulum();
    TrajectoryFile file = recorded({}, 240);
    double gap = 0.05, rate = 0;
    for (std::size_t i = 1; i < file.rows.size(); i += 2) {
        file.rows[i].position_W[1] += gap, file.rows[i].velocity_W[1] += rate;
        rate = -12 * gap, gap += rate / 240;
    }
    const std::vector<Diagnosis> found = diagnose_system(scene, file).faults;
    ASSERT_FALSE(found.empty());
    EXPECT_EQ(found.front().fault, "joint_drifts");
    EXPECT_NE(found.front().message.find("joint \"elbow\" separates by up to 0.05 m"), std::string::npos);
    EXPECT_NE(found.front().message.find("pulled back at 12"), std::string::npos) << found.front().message;
}

TEST(SystemSearch, AFileWithSomeOfTheBodiesIsComparedInThose) {
    const std::vector<std::string> names{"upper", "lower"};
    const std::string text = "t,body,qw,qx,qy,qz\n0,lower,1,0,0,0\n0.5,lower,0.8,0,0.6,0\n1,lower,0.6,0,0.8,0\n";
    const TrajectoryFile file = parse_trajectory(text, "run.csv", QuaternionColumns::by_name, names);
    EXPECT_EQ(file.bodies, (std::vector<std::string>{"lower"}));
    ASSERT_EQ(file.rows.size(), 3u);
    const Scene scene = double_pendulum();
    EXPECT_EQ(missing_bodies(scene, file), (std::vector<std::string>{"upper"}));
    Reference truth;
    truth.available = true, truth.bodies = 2;
    for (int k = 0; k < 3; ++k)
        for (int b = 0; b < 2; ++b) {
            ReferenceSample sample;
            sample.t = 0.5 * k, sample.q.w = 1.0;
            truth.samples.push_back(sample);
        }
    const FileErrors found = compute_file_errors(scene, file, truth);
    EXPECT_NEAR(found["attitude"]->max, 2 * std::acos(0.6), 1e-12);
    EXPECT_EQ(found.worst_body, "lower");
    EXPECT_FALSE(found["joint_gap"] || found["energy"] || found["omega"]);
    EXPECT_TRUE(diagnose_system(scene, file).faults.empty());
}

}  // namespace
}  // namespace polhode
