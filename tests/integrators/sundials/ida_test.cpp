// IDA on mechanisms in maximal coordinates, against joint coordinates solved by Taylor series.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "integrators/maximal/constrained.h"
#include "integrators/method.h"
#include "integrators/sundials/ida_session.h"
#include "integrators/truth/jointed_start.h"
#include "motion/mechanism_motion.h"
#include "scene/scene_file.h"

namespace polhode::maximal {
namespace {

// every column of the coloured Jacobian agrees with a central difference in this unknown
TEST(IdaMechanism, ColoursGiveTheWholeJacobian) {
    for (unsigned seed = 0; seed < 6; ++seed) {
        Scene scene = random_tree(seed, 6, seed % 2 == 0);
        scene.loads = {Gravity{{1, 2, -9}, {}}, PointSpring{"b1", {0.5, 0, 0}, "b5", {0, 0.25, 0}, 5, 0.5, {}}};
        for (Joint& joint : scene.joints) joint.stiffness = {3, 2}, joint.damping = {0.5, 0.25};
        if (seed % 3 == 0) {
            Loop loop;
            loop.name = "loop", loop.type = LoopType::distance, loop.first = "b2", loop.second = "b4", loop.length = 1;
            scene.loops = {loop};
        }
        // two joints of one coordinate: the violation of the coupling is a constant
        std::vector<std::string> names;
        for (const Joint& joint : scene.joints)
            if (joint.type == JointType::revolute || joint.type == JointType::prismatic) names.push_back(joint.name);
        if (seed % 2 == 0 && names.size() > 1) scene.couplings = {{names[0], names[1], -1.5, 0.25}};
        scene.joints[0].armature[0] = seed % 3 == 1 && scene.joints[0].type != JointType::fixed ? 0.5 : 0;
        for (const Index index : {Index::one, Index::two}) {
            const System<double> system(scene, jointed_start<double>(scene), {}, LoopRows::shortest, {},
                                        joints_to_count(scene, index));
            const ConstrainedEquations<double> equations(system, index);
            using Number = Dual<ConstrainedEquations<double>::most_in_group>;
            const std::size_t n = static_cast<std::size_t>(equations.unknowns());
            std::vector<double> z(n), up(n), down(n);
            system.initial(z.data());
            Dice dice(seed);
            for (std::size_t i = equations.differential(); i < n; ++i) z[i] = dice.number();
            std::vector<Number> at(z.begin(), z.end()), result(n);
            std::vector<char> met(n);
            for (const Group& group : equations.groups())
                for (std::size_t i = 0; i < group.unknowns.size(); ++i) {
                    // all groups of this colour at once, as in the session
                    for (const Group& other : equations.groups())
                        for (std::size_t j = 0; other.color == group.color && j < other.unknowns.size(); ++j)
                            at[other.unknowns[j]].slope[j] = 1;
                    equations.evaluate(at.data(), result.data());
                    for (Number& x : at) x.slope = {};
                    constexpr double h = 1e-5;
                    std::vector<double> moved = z;
                    moved[group.unknowns[i]] += h, equations.evaluate(moved.data(), up.data());
                    moved[group.unknowns[i]] -= 2 * h, equations.evaluate(moved.data(), down.data());
                    std::fill(met.begin(), met.end(), 0);
                    for (const int other : group.coupled_groups)
                        for (const int row : equations.groups()[other].unknowns) met[row] = 1;
                    for (std::size_t row = 0; row < n; ++row) {
                        const double difference = (up[row] - down[row]) / (2 * h);
                        const double slope = met[row] ? result[row].slope[i] : 0;
                        EXPECT_NEAR(slope, difference, 1e-6 * (1 + std::abs(difference))) << seed << " " << row;
                    }
                }
        }
    }
}

TEST(IdaMechanism, ProjectionClosesJointsAndRemovesTheirVelocityErrors) {
    for (unsigned seed = 0; seed < 4; ++seed) {
        const Scene scene = random_tree(seed, 6, seed % 2 == 0);
        const System<double> system(scene, jointed_start<double>(scene));
        const ConstrainedEquations<double> equations(system, Index::two);
        std::vector<double> y(static_cast<std::size_t>(system.dimension()));
        system.initial(y.data());
        Dice dice(seed);
        for (double& component : y) component += 1e-3 * dice.number();
        const JointGap<double> open = system.gap(y.data());
        EXPECT_GT(open.point, 1e-4);
        EXPECT_GT(open.velocity, 1e-4);
        equations.project(y.data());
        const JointGap<double> closed = system.gap(y.data());
        EXPECT_LT(closed.point, 1e-13) << seed;
        EXPECT_LT(closed.turn, 1e-13) << seed;
        EXPECT_LT(closed.velocity, 1e-12) << seed;
    }
}

Trajectory run(const Scene& scene, const char* method, double tolerance, bool reactions = false) {
    Problem problem = pose(scene);
    problem.reactions = reactions;
    Settings settings;
    settings.tolerance = tolerance, settings.samples = 4;
    return solve(problem, *find_method(method), settings);
}

double distance(const Trajectory& a, const Trajectory& b) {
    double worst = 0;
    for (std::size_t i = 0; i < a.samples.size(); ++i) {
        const Sample &x = a.samples[i], &y = b.samples[i];
        worst = std::max({worst, 2 * length(vector_part(conjugate(normalized(x.q)) * normalized(y.q))),
                          length(x.position_W - y.position_W), length(x.velocity_W - y.velocity_W)});
    }
    return worst;
}

JointViolations<double> violations(const Scene& scene, const Trajectory& trajectory) {
    const MechanismMeasure<double> measure(scene);
    std::vector<BodyMotion<double>> motions;
    for (const Sample& s : trajectory.at(trajectory.moments() - 1)) motions.push_back(s);
    return measure.violations(motions);
}

// planar four-bar linkage: 2 of the closure's 5 equations are independent
Scene four_bar() {
    Scene scene;
    scene.name = "four bar", scene.duration = 1;
    const Vector3<double> corners[] = {{0, 0, 0}, {0.25, 0, 1}, {1.25, 0, 1.5}, {1.5, 0, 0.25}};
    for (int i = 0; i < 3; ++i) {
        Body body;
        body.mass = 1 + i, body.inertia_B = diagonal(Vector3<double>{0.1, 0.1, 0.05});
        body.center_of_mass = 0.5 * (corners[i] + corners[i + 1]);
        scene.bodies.push_back({std::string(1, static_cast<char>('a' + i)), body, {}});
        Joint joint;
        joint.name = "to " + scene.bodies.back().name, joint.child = scene.bodies.back().name;
        joint.parent = i == 0 ? "world" : scene.bodies[static_cast<std::size_t>(i) - 1].name;
        joint.parent_point = joint.child_point = corners[i], joint.axes[0] = {0, 1, 0};
        scene.joints.push_back(joint);
    }
    Loop loop;
    loop.name = "closure", loop.type = LoopType::revolute, loop.first = "c";
    loop.first_point = loop.second_point = corners[3], loop.first_axis = loop.second_axis = {0, 1, 0};
    scene.loops = {loop};
    scene.loads = {Gravity{{0, 0, -9.75}, {}}};
    return scene;
}

TEST(IdaMechanism, ErrorsFallWithTheTolerance) {
    std::vector<Scene> scenes{four_bar()};
    for (unsigned seed = 0; seed < 2; ++seed) {
        scenes.push_back(random_tree(seed, 4, seed == 1));
        scenes.back().duration = 1;
        scenes.back().loads = {Gravity{{1, 2, -9}, {}},
                               Impulse{{1, 0, 2}, Frame::body, {0.5, 0, 0}, Frame::body, 0.3, "b2"}};
        for (Joint& joint : scenes.back().joints) joint.stiffness = {3, 2}, joint.damping = {0.5, 0.25};
    }
    for (const Scene& scene : scenes) {
        const Trajectory reference = run(scene, "taylor", 1e-12);
        ASSERT_EQ(reference.status, Status::ok) << reference.message;
        for (const char* method : {"ida_index1", "ida_index2"}) {
            const Trajectory coarse = run(scene, method, 1e-5), fine = run(scene, method, 1e-9);
            ASSERT_EQ(coarse.status, Status::ok) << scene.name << ": " << coarse.message;
            ASSERT_EQ(fine.status, Status::ok) << scene.name << ": " << fine.message;
            EXPECT_LT(distance(coarse, reference), 1e-2) << method << " " << scene.name;
            EXPECT_LT(distance(fine, reference), 3e-6) << method << " " << scene.name;
            EXPECT_GT(distance(coarse, reference), distance(fine, reference));
            EXPECT_GT(fine.steps, coarse.steps);
        }
    }
}

TEST(IdaMechanism, StabilisedIndex2KeepsJointsClosed) {
    const Scene scene = four_bar();
    const Trajectory drifting = run(scene, "ida_index1", 1e-5), closed = run(scene, "ida_index2", 1e-5);
    const JointViolations<double> open = violations(scene, drifting), shut = violations(scene, closed);
    EXPECT_LT(shut.gap + shut.turn, 1e-7);
    EXPECT_GT(open.gap + open.turn, 10 * (shut.gap + shut.turn));
    for (const Sample& sample : closed.samples) EXPECT_NEAR(squared_norm(sample.q), 1, 1e-6);
}

TEST(IdaMechanism, MultipliersAreTheReactions) {
    Scene scene = random_tree(3, 4, false);
    scene.loads = {Gravity{{1, 2, -9}, {}}};
    const Trajectory trajectory = run(scene, "ida_index2", 1e-9, true);
    ASSERT_EQ(trajectory.status, Status::ok) << trajectory.message;
    ASSERT_EQ(trajectory.reactions.size(), 5 * scene.joints.size());
    System<double> system(scene, mechanism_initial_motions(scene));
    std::vector<double> y(static_cast<std::size_t>(system.dimension()));
    // the state at the last sample, from its motion
    const Bodies end = trajectory.at(4);
    System<double> there(scene, end);
    there.initial(y.data());
    const std::vector<Reaction<double>> expected = there.reactions(y.data());
    for (std::size_t k = 0; k < scene.joints.size(); ++k) {
        const Reaction<double>& got = trajectory.reactions[4 * scene.joints.size() + k];
        EXPECT_LT(length(got.force_W - expected[k].force_W), 1e-3 * length(expected[k].force_W) + 1e-3);
        EXPECT_GT(length(expected[k].force_W), 1e-1);
    }
}

TEST(IdaMechanism, TakesMechanismsAlone) {
    Scene one;
    one.name = "one", one.duration = 1;
    EXPECT_EQ(run(one, "ida_index1", 1e-6).status, Status::unsupported);
    EXPECT_EQ(run(one, "ida_index2", 1e-6).status, Status::unsupported);
}

}  // namespace
}  // namespace polhode::maximal
