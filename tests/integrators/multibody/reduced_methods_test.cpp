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

Scene without_restitution(const std::string& name) {
    Scene scene = find_scene(name);
    for (Joint& joint : scene.joints) joint.limits.restitution = 0;
    return scene;
}

// Positions of the bodies at the end from MuJoCo 2.2.2 (libmujoco, integrator Euler, solver Newton with tolerance 0)
// for this arm as MJCF with coordinate zero as reference, 750 steps; stiff: solref 2 h and solimp 0.9999. Both differ
// by at most 3e-14 m.
TEST(MujocoJoints, MatchMujoco) {
    const Problem problem = pose(find_scene("joints/arm6_limits_friction"));
    const std::map<std::string, std::vector<Vector3<double>>> published{
        {"mujoco_joints",
         {{0, 0, 0.125},
          {0.166008199346385, 0.18313742011423, 0.298770130240495},
          {0.283620654205547, 0.35941559199185, 0.283183077181938},
          {0.282630297880639, 0.311792934347635, 0.0357812498377333},
          {0.252977196378271, 0.272762657683626, -0.0854071836403795},
          {0.176457188554339, 0.212916454161957, -0.067275848149898}}},
        {"mujoco_joints_stiff",
         {{0, 0, 0.125},
          {0.165871786209341, 0.183097968467794, 0.299378608553595},
          {0.286318585404975, 0.362599070930063, 0.283773523274791},
          {0.291476099959116, 0.321746591021062, 0.0352156076315586},
          {0.262062960252419, 0.288175527440193, -0.0879287963906101},
          {0.186599982051187, 0.230725631640737, -0.0601713938890792}}},
    };
    for (const auto& [method, positions] : published) {
        const Trajectory run = stepped(problem, method, 1e-3, 1);
        const Bodies end = run.at(1);
        ASSERT_EQ(end.size(), positions.size());
        for (std::size_t b = 0; b < end.size(); ++b)
            EXPECT_LT(length(end[b].position_W - positions[b]), 1e-12) << method << " " << b;
    }
}

// A block that a force f < F pulls: at a constant rate a = 0 = a_ref - R f, hence x' = R f / b with R = (1 - d) / (d
// m).
TEST(MujocoJoints, CreepUnderFriction) {
    Scene scene = find_scene("joints/coulomb_oscillator");
    constexpr double f = 0.25, b = 2 / (0.95 * 0.02), R = (1 - 0.9) / (0.9 * 2);
    scene.joints[0].stiffness[0] = 0, scene.joints[0].coordinate[0] = 0;
    scene.loads.push_back(Motor{scene.joints[0].name, f, {}});
    for (const double step : {4e-3, 1e-3})
        EXPECT_NEAR(stepped(pose(scene), "mujoco_joints", step).samples.back().velocity_W[0], R * f / b, 1e-12);
    // T = 2 h, d = 0.9999
    const double stiff = stepped(pose(scene), "mujoco_joints_stiff", 1e-3).samples.back().velocity_W[0];
    EXPECT_NEAR(stiff, (1 - 0.9999) / (0.9999 * 2) * f * 0.9999 * 1e-3, 1e-14);
}

// At rest on a limit: k d(r) r = (1 - d(r)) / d(r) g.
TEST(MujocoJoints, PassTheLimitAtRest) {
    const Problem problem = pose(without_restitution("joints/bouncing_slider"));
    constexpr double T = 0.95 * 0.02;
    const auto excess = [&](double r) {
        const double d = 0.9 + 0.05 * 2 * (r / 0.001) * (r / 0.001);
        return d * r / (T * T) - (1 - d) / d * 2;
    };
    double low = 0, high = 5e-4;
    for (int i = 0; i < 60; ++i) (excess((low + high) / 2) < 0 ? low : high) = (low + high) / 2;
    for (const double step : {4e-3, 1e-3}) {
        const double z = stepped(problem, "mujoco_joints", step).samples.back().position_W[2];
        EXPECT_NEAR(z, 0.25 - low, 1e-12) << step;
    }
    EXPECT_GT(low, 8e-5);
}

// A limit is a critically damped spring, x = v t exp(-t / T), until the force changes sign at t = 2 T: the block leaves
// with the rate v exp(-2), whatever the time constant. Deviation at 64 m/s: 1e-4, from the impedance within 1 mm.
TEST(MujocoJoints, LeaveALimitWithAPartOfTheSpeed) {
    Scene scene = without_restitution("joints/bouncing_slider");
    scene.loads.clear(), scene.duration = 0.25;
    scene.joints[0].rate[0] = -64;
    const Trajectory run = stepped(pose(scene), "mujoco_joints", 1e-5);
    EXPECT_NEAR(run.samples.back().velocity_W[2], 64 * std::exp(-2), 64 * 1e-3);
    // with a time constant of two steps the part depends on the time of arrival within the step
    double least = 1, most = 0;
    for (int i = 0; i < 16; ++i) {
        scene.joints[0].coordinate[0] = 1.25 + i / 256.0;
        const double part = stepped(pose(scene), "mujoco_joints_stiff", 1e-3).samples.back().velocity_W[2] / 64;
        least = std::min(least, part), most = std::max(most, part);
    }
    EXPECT_LT(least, 0.02);
    EXPECT_GT(most, 0.2);
    EXPECT_LT(most, 0.25);
}

// The soft model converges to its own motion; the time constant of two steps to dry friction and rest on a limit.
// Measured orders: 1.00 and 1.01 of the former, 1.00 and 1.00 of the latter.
TEST(MujocoJoints, HaveOrderOne) {
    for (const char* name : {"joints/coulomb_oscillator", "joints/arm6_limits_friction"}) {
        const Problem problem = pose(find_scene(name));
        // the largest change of a position when the step is halved
        const auto change = [&](double steps) {
            const Trajectory one = stepped(problem, "mujoco_joints", problem.scene.duration / steps, 8),
                             other = stepped(problem, "mujoco_joints", problem.scene.duration / (2 * steps), 8);
            double largest = 0;
            for (std::size_t i = 0; i < one.samples.size(); ++i)
                largest = std::max(largest, length(one.samples[i].position_W - other.samples[i].position_W));
            return largest;
        };
        const double coarse = change(1000), fine = change(8000);
        EXPECT_NEAR(std::log2(coarse / fine) / 3, 1, 0.1) << name;
        EXPECT_GT(position_error(problem, "mujoco_joints", problem.scene.duration / 8000), 5 * fine) << name;
    }
    for (const char* name : {"joints/coulomb_oscillator", "joints/bouncing_slider"})
        EXPECT_NEAR(position_order(pose(without_restitution(name)), "mujoco_joints_stiff", 1000, 5e-3), 1, 0.1) << name;
}

TEST(ReducedMethods, RefuseWhatTheyDoNotRepresent) {
    for (const char* method : {"mujoco_joints", "bullet_joints"}) {
        const auto why = [&](const std::string& scene) {
            return refusal(*find_method(method), pose(find_scene(scene)));
        };
        EXPECT_NE(why("joints/pendulum_with_stops").find("\"hinge\" have a restitution"), std::string::npos);
        EXPECT_NE(why("mechanisms/four_bar").find("does not support loops"), std::string::npos);
        EXPECT_NE(why("joints/rack_and_pinion").find("does not support couplings"), std::string::npos);
        EXPECT_NE(why("joints/screw_jack").find("does not support couplings"), std::string::npos);
        EXPECT_NE(why("joints/kapitza_cart").find("prescribed motions"), std::string::npos);
        EXPECT_EQ(why("joints/arm6_limits_friction"), "");
    }
}

// Positions of the bodies at the end from Bullet 3.24 in binary64 (btMultiBodyDynamicsWorld, no damping, 10
// iterations), of the arm without the armature that Bullet does not have, 750 steps. They differ by at most 1e-13 m.
TEST(BulletJoints, MatchBullet) {
    Scene scene = find_scene("joints/arm6_limits_friction");
    for (Joint& joint : scene.joints) joint.armature = {};
    const Trajectory run = stepped(pose(scene), "bullet_joints", 1e-3, 1);
    const Bodies end = run.at(1);
    const std::vector<Vector3<double>> published{{0, 0, 0.125},
                                                 {0.177499184876359, 0.171852661896935, 0.299368658753972},
                                                 {0.310492338787063, 0.344112010150251, 0.283604740138432},
                                                 {0.315076010668458, 0.305052956558412, 0.034747466215017},
                                                 {0.293291414447469, 0.268435623674079, -0.0890012346934554},
                                                 {0.226596194432973, 0.195896091636024, -0.0964436078981548}};
    ASSERT_EQ(end.size(), published.size());
    for (std::size_t b = 0; b < end.size(); ++b) EXPECT_LT(length(end[b].position_W - published[b]), 1e-12) << b;
}

TEST(BulletJoints, HaveOrderOneWithFriction) {
    for (const char* name : {"joints/coulomb_oscillator", "joints/coulomb_pendulum"})
        EXPECT_NEAR(position_order(pose(find_scene(name)), "bullet_joints", 1000, 0.02), 1, 0.1) << name;
}

// A block that is p beyond a limit leaves it with the rate 0.2 p / h, where p is at most its speed times h.
TEST(BulletJoints, LeaveALimitWithAPartOfTheSpeed) {
    Scene scene = without_restitution("joints/bouncing_slider");
    scene.loads.clear(), scene.duration = 1;
    scene.joints[0].rate[0] = -4;
    for (const double step : {1.0 / 128, 1.0 / 1024})
        for (const double part : {0.25, 0.5, 1.0}) {
            scene.joints[0].coordinate[0] = 1.25 + (1 - part) * 4 * step;  // part * 4 h beyond the limit at a step
            const Trajectory run = stepped(pose(scene), "bullet_joints", step, 8);
            EXPECT_NEAR(run.samples.back().velocity_W[2], 0.2 * part * 4, 1e-9) << step << " " << part;
        }
}

// An impulse is at most 100 N s per step: 1000 kg at 1 m/s lose 0.1 m/s per step.
TEST(BulletJoints, LimitTheImpulse) {
    Scene scene = without_restitution("joints/bouncing_slider");
    scene.loads.clear(), scene.duration = 8.0 / 64;
    scene.bodies[0].body.mass = 1000;
    for (Vector3<double>& row : scene.bodies[0].body.inertia_B.row) row = 1000.0 * row;
    scene.joints[0].rate[0] = -1, scene.joints[0].coordinate[0] = 0.25;
    const Trajectory run = stepped(pose(scene), "bullet_joints", 1.0 / 64, 8);
    for (std::size_t k = 1; k <= 8; ++k)
        EXPECT_NEAR(run.samples[k].velocity_W[2], -1 + 0.1 * double(k - 1), 1e-12) << k;
}

// An arm without gravity that hits an inelastic stop with 4 rad/s at 16 times within a step of 1e-3 s, and a pendulum
// that friction holds at half of its limit: bounds for the methods in joint and in maximal coordinates.
TEST(JointLaws, ReboundAndCreep) {
    struct Bounds {
        const char* method;
        double least, most;  // rate after the impact, divided by that before
        double creep;        // rad/s
    };
    for (const Bounds& b : {Bounds{"sequential_impulses_10", 0, 1e-3, 1e-12}, Bounds{"soft_step_4", 0, 0.01, 1e-12},
                            Bounds{"xpbd_joints_10", 0, 1e-12, 1e-12}, Bounds{"mujoco_joints", 0.11, 0.15, 1e-3},
                            Bounds{"mujoco_joints_stiff", 0, 0.25, 1e-6}, Bounds{"bullet_joints", 0, 0.2, 1e-12}}) {
        Scene stop = without_restitution("joints/pendulum_with_stops");
        stop.loads.clear(), stop.duration = 0.3;
        for (int i = 0; i < 16; ++i) {
            stop.joints[0].coordinate[0] = i / 4000.0;
            const double part = -stepped(pose(stop), b.method, 1e-3, 1).samples.back().angular_velocity_B[1] / 4;
            EXPECT_GE(part, b.least - 1e-12) << b.method;
            EXPECT_LE(part, b.most + 1e-12) << b.method;
        }
        Scene hold = find_scene("joints/coulomb_pendulum");
        hold.duration = 4;
        hold.joints[0].coordinate[0] = std::asin(0.5 * hold.joints[0].friction / (1.5 * 9.75 * 0.5));
        const double creep = length(stepped(pose(hold), b.method, 1e-3, 1).samples.back().angular_velocity_B);
        EXPECT_LE(creep, b.creep) << b.method;
    }
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
