// Methods in joint coordinates: order, implicit damping, linear solver, and invariants of the variational integrator.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "integrators/multibody/armature.h"
#include "integrators/multibody/multibody_cases.h"

namespace polhode {
namespace {

using namespace multibody_cases;

// a random state of the mechanism near its start, with arbitrary rates
std::vector<double> any_state(const Tree<double>& tree) {
    const auto any = [] { return *rc::gen::inRange(-1000, 1001) / 500.0; };
    std::vector<double> y(static_cast<std::size_t>(tree.dimension()));
    tree.initial(y.data());
    for (const Link<double>& link : tree.links().links) {
        double* const x = y.data() + link.coordinate;
        for (int k = 0; k < link.coordinates(); ++k) x[k] += any() / 2;
        if (link.coordinates() > 1) {
            const Quaternion<double> q = normalized(Quaternion<double>{x[0] + 2, x[1], x[2], x[3]});
            x[0] = q.w, x[1] = q.x, x[2] = q.y, x[3] = q.z;
        }
        for (int k = 0; k < link.rates(); ++k) y[static_cast<std::size_t>(link.rate + k)] = any();
    }
    return y;
}

// M x from the bodies' masses: velocities are linear in the rates, so M_ij = sum m v_i . v_j + w_i . I w_j.
std::vector<double> mass_times(const Tree<double>& tree, const std::vector<double>& y, const std::vector<double>& x) {
    const std::size_t from = static_cast<std::size_t>(tree.links().coordinates), n = x.size();
    const auto moved_by = [&](const std::vector<double>& rates) {
        std::vector<double> state = y;
        std::copy(rates.begin(), rates.end(), state.begin() + static_cast<std::ptrdiff_t>(from));
        return tree.motions(state.data());
    };
    const auto all = moved_by(x);
    std::vector<double> product(n, 0.0);
    for (std::size_t i = 0; i < n; ++i) {
        std::vector<double> unit(n, 0.0);
        unit[i] = 1;
        const auto one = moved_by(unit);
        for (std::size_t b = 0; b < one.size(); ++b) {
            const LinkBody<double>& body = tree.links().bodies[b];
            product[i] += body.mass * dot(one[b].velocity_W, all[b].velocity_W) +
                          dot(one[b].angular_velocity_B, body.inertia_B * all[b].angular_velocity_B);
        }
    }
    return product;
}

// all types of joints and a free base; rounding error times the condition number of the matrix
RC_GTEST_PROP(ArmatureSolver, SolvesWithTheMassMatrixAndADiagonal, ()) {
    static const std::vector<Problem> problems = [] {
        std::vector<Problem> all;
        for (const char* name :
             {"free_flying_robot", "ball_joint_arm", "cart_pole_tilted", "cardan_shaft", "chain_10", "falling_cat"})
            all.push_back(pose(mechanism(name, 1)));
        return all;
    }();
    const Problem& problem = problems[*rc::gen::inRange<std::size_t>(0, problems.size())];
    const Tree<double>& tree = mechanism_of(problem).tree();
    const std::vector<double> y = any_state(tree);
    const std::size_t n = static_cast<std::size_t>(tree.links().rates);
    std::vector<double> armature(n), torque(n), x;
    for (const Link<double>& link : tree.links().links)
        for (int k = 0; k < link.rates(); ++k) {
            const std::size_t i = static_cast<std::size_t>(link.rate - tree.links().coordinates + k);
            armature[i] = link.kind == LinkJoint::free ? 0 : *rc::gen::inRange(0, 1000) / 1e4;
            torque[i] = *rc::gen::inRange(-1000, 1001) / 1000.0;
        }
    TreeWork<double>& at = tree.work<double>();
    tree.move(y.data(), at);
    multibody::ArmatureSolver solver;
    solver.copy_links(tree, at);
    solver.factorize(tree, armature);
    solver.solve(tree, torque, x);
    const std::vector<double> product = mass_times(tree, y, x);
    double largest = 0;
    for (std::size_t i = 0; i < n; ++i)
        largest = std::max(largest, std::abs(armature[i] * x[i]) + std::abs(product[i]));
    for (std::size_t i = 0; i < n; ++i)
        RC_ASSERT(std::abs(product[i] + armature[i] * x[i] - torque[i]) < 1e-10 * (1 + largest));
}

TEST(ReducedMethods, HaveTheirOrders) {
    for (const char* name : {"ball_joint_arm", "cart_pole_tilted", "free_flying_robot", "chain_10", "falling_cat"}) {
        const Case it(mechanism(name, 0.5));
        EXPECT_NEAR(it.order("reduced_semi_implicit_euler", 1e-3), 1, 0.1) << name;
        EXPECT_NEAR(it.order("reduced_implicit_damping", 1e-3), 1, 0.1) << name;
        EXPECT_NEAR(it.order("variational_tree", 2e-3), 2, 0.1) << name;
    }
    // loops, closed by projection
    const Case shaft(mechanism("cardan_shaft", 0.5));
    EXPECT_NEAR(shaft.order("reduced_semi_implicit_euler", 1e-3), 1, 0.1);
    EXPECT_LT(shaft.off("reduced_semi_implicit_euler", 1e-3).gap, 1e-14);
}

// Damping rates of 4891 /s at h = 2e-3 s: explicit damping diverges, implicit damping has an error of 4.5e-3 rad.
// Without dampers the two methods are identical.
TEST(ReducedMethods, ImplicitDampersDoNotBlowUp) {
    const Case stiff(mechanism("torsion_chain", 0.5));
    EXPECT_EQ(stiff.run("reduced_semi_implicit_euler", 2e-3).status, Status::diverged);
    EXPECT_LT(stiff.off("reduced_implicit_damping", 2e-3).attitude, 1e-2);
    EXPECT_NEAR(stiff.order("reduced_implicit_damping", 1e-3), 1, 0.1);
    const Case it(mechanism("double_pendulum", 0.5));
    EXPECT_EQ(it.run("reduced_implicit_damping", 1e-3).samples.back().q,
              it.run("reduced_semi_implicit_euler", 1e-3).samples.back().q);
}

double largest_energy_error(const Case& it, const Trajectory& run, std::size_t from, std::size_t to) {
    const double start = it.invariants(run.at(0)).energy;
    double largest = 0;
    for (std::size_t k = from; k < to; ++k)
        largest = std::max(largest, std::abs(it.invariants(run.at(k)).energy - start));
    return largest;
}

// The chaotic double pendulum, 20,000 steps: the energy error of the last fifth stays in the band of the first fifth.
// Measured over 10^6 steps of 0.01 s: at most 0.285 J in the first tenth and 0.228 J in the last, of a kinetic energy
// up to 29.7 J. The physical pendulum at 0.02 s: 6.94e-3 J in each tenth, of 17.7 J.
TEST(VariationalTree, KeepsTheEnergyInItsBand) {
    const Case it(mechanism("double_pendulum", 1));
    Scene scene = mechanism("double_pendulum", 200);
    const Problem problem = pose(scene);
    const Trajectory run = stepped(problem, "variational_tree", 0.01, 2000);
    ASSERT_EQ(run.status, Status::ok) << run.message;
    const double early = largest_energy_error(it, run, 0, 400), late = largest_energy_error(it, run, 1600, 2000);
    EXPECT_LT(late, 1.5 * early);
    EXPECT_LT(early, 1);  // J, of a kinetic energy up to 29.7 J
}

// Momenta of symmetries: linear and angular momentum of a free-flying robot without external forces, and a gyroscope's
// about the vertical. They are about W's origin, because the centre of mass moves in a straight line only to O(h^2).
TEST(VariationalTree, KeepsMomentaToRounding) {
    const Case robot(mechanism("free_flying_robot", 1));
    const Trajectory run = robot.run("variational_tree", 1e-2);
    const auto about_origin = [&](std::size_t k) {
        const auto now = robot.invariants(run.at(k));
        Vector3<double> moment;
        double mass = 0;
        for (std::size_t b = 0; b < run.at(k).size(); ++b) {
            const double m = mechanism_of(robot.problem).tree().links().bodies[b].mass;
            moment = moment + m * run.at(k)[b].position_W, mass += m;
        }
        return now.angular_momentum_W + (1 / mass) * cross(moment, now.linear_momentum_W);
    };
    const auto before = robot.invariants(run.at(0)), after = robot.invariants(run.at(10));
    EXPECT_LT(length(after.linear_momentum_W - before.linear_momentum_W), 1e-13 * before.linear_size);
    EXPECT_LT(length(about_origin(10) - about_origin(0)), 1e-12 * before.angular_size);
    const Case top(mechanism("top_on_spherical_joint", 1));
    const Trajectory spun = top.run("variational_tree", 1e-3);
    EXPECT_NEAR(top.invariants(spun.at(10)).angular_momentum_W[2], top.invariants(spun.at(0)).angular_momentum_W[2],
                1e-12 * top.invariants(spun.at(0)).angular_size);
}

// A step too long for solving its implicit equations fails with a message.
TEST(VariationalTree, SaysWhereItsEquationsAreNotSolved) {
    const Problem problem = pose(mechanism("rope_mass_ratio", 1));
    const Trajectory run = stepped(problem, "variational_tree", 4e-3);
    EXPECT_EQ(run.status, Status::failed);
    EXPECT_NE(run.message.find("implicit equations"), std::string::npos) << run.message;
}

}  // namespace
}  // namespace polhode
