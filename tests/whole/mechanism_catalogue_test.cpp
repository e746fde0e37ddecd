// The built-in mechanisms: degrees of freedom counted by hand, and initial states from published sources.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "experiment/kinds/mechanism_figures.h"
#include "motion/mechanism.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

struct Count {
    const char* name;
    int tree;       ///< degrees of freedom: revolute, prismatic 1, universal 2, spherical 3, free base 6
    int rows;       ///< equations of the loops: spherical 3, revolute 5, distance 1
    int redundant;  ///< number of these implied by the others
};

// In a planar loop of parallel hinges, two of a hinge's five equations and two of a spherical joint's three are
// independent. Two shafts joined by a universal joint: the two tilts of the bearing remain. Bricard's six hinges: one
// of five degrees of freedom remains, so four equations are independent.
constexpr Count counts[]{{"andrews_squeezer", 7, 9, 3},
                         {"babyboot", 2, 0, 0},
                         {"ball_joint_arm", 6, 0, 0},
                         {"bricard", 5, 5, 1},
                         {"cardan_shaft", 3, 5, 3},
                         {"cart_pole_tilted", 2, 0, 0},
                         {"chain_10", 10, 0, 0},
                         {"chain_100", 100, 0, 0},
                         {"double_four_bar", 5, 10, 6},
                         {"double_pendulum", 2, 0, 0},
                         {"double_pendulum_spatial", 3, 0, 0},
                         {"elliptic_trammel", 3, 5, 3},
                         {"falling_cat", 8, 0, 0},
                         {"flyball_governor", 4, 2, 0},
                         {"four_bar", 3, 5, 3},
                         {"free_body_as_mechanism", 6, 0, 0},
                         {"free_flying_robot", 10, 0, 0},
                         {"furuta_pendulum", 2, 0, 0},
                         {"gimbal_gyroscope", 3, 0, 0},
                         {"masses_on_spring", 12, 0, 0},
                         {"physical_pendulum", 1, 0, 0},
                         {"rope_mass_ratio", 33, 0, 0},
                         {"rotating_double_pendulum", 3, 0, 0},
                         {"slider_crank", 3, 5, 3},
                         {"spatial_slider_crank", 4, 3, 0},
                         {"spherical_pendulum", 3, 0, 0},
                         {"spring_governor", 4, 0, 0},
                         {"top_on_spherical_joint", 3, 0, 0},
                         {"torsion_chain", 6, 0, 0},
                         {"triple_pendulum", 3, 0, 0},
                         {"welded_pendulum", 1, 0, 0}};

TEST(MechanismCatalogue, LoopsLeaveTheDegreesOfFreedomThatTheyShould) {
    for (const Count& count : counts) {
        const auto scene = std::make_shared<const Scene>(find_scene(std::string("mechanisms/") + count.name));
        const MechanismModel model(scene);
        const Tree<double>& tree = model.tree();
        EXPECT_EQ(tree.links().rates, count.tree) << count.name;
        EXPECT_EQ(tree.loop_rows(), std::size_t(count.rows)) << count.name;
        EXPECT_EQ(tree.independent_loop_rows(), std::size_t(count.rows - count.redundant)) << count.name;
    }
}

// The initial states in the files already close the loops to rounding: only `dependent` joints are moved.
TEST(MechanismCatalogue, TheStartIsTheOneWritten) {
    for (const Count& count : counts) {
        const Scene scene = find_scene(std::string("mechanisms/") + count.name);
        Scene open = scene;
        open.loops.clear();
        for (Joint& joint : open.joints) joint.dependent = false;
        const std::vector<BodyMotion<double>> closed = mechanism_initial_motions(scene),
                                              written = mechanism_initial_motions(open);
        ASSERT_EQ(closed.size(), written.size());
        for (std::size_t i = 0; i < closed.size(); ++i)
            for (int k = 0; k < 3; ++k) {
                EXPECT_NEAR(closed[i].position_W[k], written[i].position_W[k], 4e-16) << count.name;
                EXPECT_NEAR(closed[i].velocity_W[k], written[i].velocity_W[k], 4e-15) << count.name;
            }
    }
}

double decimal(const char* text) { return std::stod(text); }

// Each initial value agrees with the source's 30 digits up to the rounding of the lengths (relative 1e-16), which the
// loops magnify about ten times.
TEST(MechanismCatalogue, AndrewsStartIsTheTestSets) {
    const Scene scene = find_scene("mechanisms/andrews_squeezer");
    const std::vector<BodyMotion<double>> bodies = mechanism_initial_motions(scene);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const figures::AndrewsBody& body = figures::andrews_bodies[i];
        ASSERT_EQ(scene.bodies[i].name, body.name);
        double angle = 0;
        for (const int part : body.parts)
            if (part >= 0) angle += decimal(figures::andrews_start[std::size_t(part)]);
        EXPECT_NEAR(2 * std::atan2(bodies[i].q.z, bodies[i].q.w), angle, 2e-15) << body.name;
        EXPECT_EQ(bodies[i].q.x, 0);
        EXPECT_EQ(bodies[i].q.y, 0);
    }
}

// The initial non-zero accelerations and the multipliers, which are the forces of the loop, agree with the test set.
TEST(MechanismCatalogue, AndrewsFirstForcesAreTheTestSets) {
    const auto scene = std::make_shared<const Scene>(find_scene("mechanisms/andrews_squeezer"));
    MechanismModel model(scene);
    std::vector<double> y(std::size_t(model.dimension())), rates(y.size());
    model.initial(y.data());
    model.enter(0, y.data());
    model.derivative(y.data(), rates.data());
    const double scale = decimal(figures::andrews_start_beta_acceleration);
    const std::size_t joints = y.size() / 2;
    for (std::size_t j = 0; j < joints; ++j) {
        const std::string& name = scene->joints[j].name;
        const double expected = name == "beta"    ? decimal(figures::andrews_start_beta_acceleration)
                                : name == "theta" ? decimal(figures::andrews_start_theta_acceleration)
                                                  : 0;
        // links are in the order of the file's joints, because each parent comes before its child
        EXPECT_NEAR(rates[joints + j], expected, 1e-13 * scale) << name;
    }
    const std::vector<Reaction<double>> reactions = model.reactions(y.data());
    ASSERT_EQ(reactions.size(), scene->joints.size() + scene->loops.size());
    const Vector3<double>& force = reactions[scene->joints.size()].force_W;
    EXPECT_NEAR(force[0], decimal(figures::andrews_start_lambda_1), 1e-12 * std::abs(force[0]));
    EXPECT_NEAR(force[1], decimal(figures::andrews_start_lambda_2), 1e-11 * std::abs(force[1]));
}

}  // namespace
}  // namespace polhode
