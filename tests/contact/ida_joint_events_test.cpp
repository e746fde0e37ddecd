// IDA on mechanisms with limits, friction and prescribed motions of joints and with formula loads, against the truth.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "catalogue.h"
#include "integrators/contact/solve_joints.h"
#include "integrators/method.h"
#include "integrators/truth/fresh_cache.h"
#include "integrators/truth/reference.h"

namespace polhode {
namespace {

constexpr long ida_samples = 6;

/// Largest errors of a run: positions and velocities of the bodies, times of events, torques and forces of joints
/// relative to the largest one above 1. The number of impacts that accumulate depends on the tolerance.
struct IdaErrors {
    double motion = 0, events = 0, reactions = 0;
};

IdaErrors errors_of_ida(const Scene& scene, const DecimalReference& truth, const char* method, double tolerance,
                        bool are_events_finite) {
    const std::string place = scene.name + " by " + method;
    Settings settings;
    settings.samples = ida_samples, settings.tolerance = tolerance;
    Problem problem = pose(scene);
    problem.reactions = true;
    const contact::JointRun<double> run =
        contact::follow_joints_in_binary64(problem, settings, find_method(method)->steps);
    EXPECT_EQ(run.fault, "") << place;
    IdaErrors errors;
    EXPECT_EQ(run.motions.size(), static_cast<std::size_t>(ida_samples + 1)) << place;
    for (std::size_t i = 0; i < run.motions.size(); ++i)
        for (std::size_t b = 0; b < run.motions[i].size(); ++b)
            for (std::size_t k = 0; k < 3; ++k) {
                const DecimalColumns& row = truth.columns[i * run.motions[i].size() + b];
                const BodyMotion<double>& body = run.motions[i][b];
                errors.motion = std::max({errors.motion, std::abs(body.position_W[k] - std::stod(row[7 + k])),
                                          std::abs(body.velocity_W[k] - std::stod(row[10 + k]))});
            }
    double largest = 1;
    for (std::size_t i = 0; i < run.reactions.size(); ++i)
        for (std::size_t j = 0; j < run.reactions[i].size(); ++j)
            for (std::size_t k = 0; k < 3; ++k) {
                const ReactionDecimals& expected = truth.reactions[i * run.reactions[i].size() + j];
                const double force = std::stod(expected[k]), torque = std::stod(expected[3 + k]);
                largest = std::max({largest, std::abs(force), std::abs(torque)});
                errors.reactions = std::max({errors.reactions, std::abs(run.reactions[i][j].force_W[k] - force),
                                             std::abs(run.reactions[i][j].torque_W[k] - torque)});
            }
    errors.reactions /= largest;
    if (!are_events_finite) return errors;
    EXPECT_EQ(run.events.size(), truth.contact_events.size()) << place;
    for (std::size_t i = 0; i < std::min(run.events.size(), truth.contact_events.size()); ++i) {
        const contact::JointEvent<double>& event = run.events[i];
        const DecimalContactEvent& expected = truth.contact_events[i];
        EXPECT_EQ(contact::joint_event_names[static_cast<std::size_t>(event.kind)], expected.event) << place << i;
        EXPECT_EQ(event.joint, expected.plane) << place << i;
        errors.events = std::max(errors.events, std::abs(event.t - std::stod(expected.t)));
    }
    return errors;
}

class IdaJointEvents : public ::testing::TestWithParam<const char*> {};

TEST_P(IdaJointEvents, ConvergeToTheTruth) {
    const FreshCache cache;
    const Scene scene = find_scene(GetParam());
    const bool are_events_finite = scene.name != "joints/gripper_closes";
    const DecimalReference truth = decimal_reference(scene, ida_samples, 17);
    ASSERT_TRUE(truth.available) << truth.message;
    for (const char* method : {"ida_index1", "ida_index2"}) {
        ASSERT_EQ(refusal(*find_method(method), pose(scene)), "") << method;
        const IdaErrors coarse = errors_of_ida(scene, truth, method, 1e-6, are_events_finite),
                        fine = errors_of_ida(scene, truth, method, 1e-9, are_events_finite);
        EXPECT_LT(coarse.motion, 1e-2) << method;
        if (!are_events_finite) {
            // the errors depend on the impact that ends the series
            EXPECT_LT(fine.motion, 1e-7) << method;
            EXPECT_LT(fine.reactions, 1e-6) << method;
            continue;
        }
        EXPECT_LT(fine.motion, std::max(coarse.motion / 20, 1e-12)) << method;
        EXPECT_LT(fine.reactions, std::max(coarse.reactions / 5, 1e-10)) << method;
        EXPECT_LT(fine.events, std::max(coarse.events / 5, 1e-10)) << method;
    }
}

INSTANTIATE_TEST_SUITE_P(Catalogue, IdaJointEvents,
                         ::testing::Values("formulas/flywheel_servo", "joints/arm6_limits_friction",
                                           "joints/bead_on_rotating_rod", "joints/coulomb_oscillator",
                                           "joints/coulomb_pendulum", "joints/driven_slider_crank",
                                           "joints/gripper_closes", "joints/hopper_in_flight", "joints/kapitza_cart",
                                           "joints/pendulum_with_stops", "joints/reaction_wheels",
                                           "joints/runner_in_flight", "joints/stick_slip_belt"),
                         [](const auto& parameter) {
                             std::string name = parameter.param;
                             std::ranges::replace(name, '/', '_');
                             return name;
                         });

}  // namespace
}  // namespace polhode
