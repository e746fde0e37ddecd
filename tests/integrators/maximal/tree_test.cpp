// The articulated-body recursion (src/motion/tree.h) against an independent formulation, maximal coordinates with
// multipliers: motions, reactions (and so accelerations), impulses.
#include "motion/tree.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "integrators/truth/jointed_start.h"
#include "integrators/truth/maximal_form.h"
#include "motion/mechanism_motion_of.h"
#include "motion/traced.h"

namespace polhode {
namespace {

double off(const Vector3<double>& a, const Vector3<double>& b) { return length(Vector3<double>(a - b)); }

/// Every kind of load on random bodies; springs and dampers in every second joint.
Scene loaded_tree(unsigned seed, int count, bool free_base) {
    Scene scene = random_tree(seed, count, free_base);
    Dice dice(seed + 1000);
    const auto body = [&] { return "b" + std::to_string(static_cast<int>((dice.number() + 1) / 2 * count) % count); };
    scene.loads.push_back(Gravity{dice.vector(), {}});
    for (const Frame frame : {Frame::body, Frame::world}) {
        scene.loads.push_back(Torque{dice.vector(), frame, {}, body()});
        for (const Frame at : {Frame::body, Frame::world})
            scene.loads.push_back(Force{dice.vector(), frame, dice.vector(), at, {}, body()});
    }
    scene.loads.push_back(Drag{{0.1, 0.2, 0.3}, 0.4, {}, body()});
    scene.loads.push_back(Spring{2, dice.orientation(), {}, body()});
    scene.loads.push_back(PointSpring{body(), dice.vector(), "world", 4 * dice.vector(), 3, 0.25, {}});
    scene.loads.push_back(
        PointSpring{"b0", dice.vector(), "b" + std::to_string(count - 1), 4 * dice.vector(), 3, 0, {}});
    for (std::size_t j = 0; j < scene.joints.size(); ++j) {
        Joint& joint = scene.joints[j];
        if (joint.type == JointType::revolute) scene.loads.push_back(Motor{joint.name, 0.5, {}});
        if (j % 2 == 1 || joint.type == JointType::fixed) continue;
        joint.stiffness = {1.5, 2.5}, joint.rest = {0.25, -0.5}, joint.damping = {0.25, 0.75};
        joint.rest_orientation = dice.orientation();
        if (joint.type != JointType::universal) joint.stiffness[1] = joint.rest[1] = joint.damping[1] = 0;
    }
    return scene;
}

struct Both {
    Tree<double> tree;
    truth::MaximalForm<double> bodies;
    std::vector<double> y, z;

    explicit Both(const Scene& scene)
        : tree(scene, bodies_mass_properties<double>(scene)),
          bodies(scene, jointed_start<double>(scene)),
          y(static_cast<std::size_t>(tree.dimension())),
          z(static_cast<std::size_t>(bodies.dimension())) {
        tree.initial(y.data());
        bodies.initial(z.data());
        tree.set_loads(scene, 0);
        tree.apply_impulses(scene, 0, y.data());
        bodies.enter(0, z.data());
    }
};

void expect_alike(const Scene& scene) {
    const Both both(scene);
    const auto a = both.tree.motions(both.y.data());
    const auto b = both.bodies.motion(both.z.data());
    ASSERT_EQ(a.size(), b.size());
    double speed = 1;
    for (const auto& m : b) speed = std::max({speed, length(m.velocity_W), length(m.angular_velocity_B)});
    for (std::size_t i = 0; i < a.size(); ++i) {
        EXPECT_LT(off(a[i].position_W, b[i].position_W), 1e-13) << scene.name << " body " << i;
        EXPECT_LT(off(a[i].velocity_W, b[i].velocity_W), 1e-11 * speed) << scene.name << " body " << i;
        EXPECT_LT(off(a[i].angular_velocity_B, b[i].angular_velocity_B), 1e-11 * speed) << scene.name << " body " << i;
        const Quaternion<double> between = conjugate(a[i].q) * b[i].q;
        EXPECT_LT(length(vector_part(between)), 1e-13) << scene.name << " body " << i;
    }
    const auto one = both.tree.reactions(scene, both.y.data());
    const auto other = both.bodies.reactions(both.z.data());
    ASSERT_EQ(one.size(), other.size());
    double largest = 0;
    for (const auto& r : other) largest = std::max({largest, length(r.force_W), length(r.torque_W)});
    // both lose accuracy by the mass ratios in a tree of a dozen bodies
    for (std::size_t j = 0; j < one.size(); ++j) {
        EXPECT_LT(off(one[j].force_W, other[j].force_W), 1e-9 * largest) << scene.name << " joint " << j;
        EXPECT_LT(off(one[j].torque_W, other[j].torque_W), 1e-9 * largest) << scene.name << " joint " << j;
    }
}

TEST(Tree, MovesAsBodiesHeldByMultipliers) {
    for (unsigned seed = 0; seed < 40; ++seed)
        for (const bool free_base : {false, true}) {
            Scene scene = loaded_tree(seed, 1 + static_cast<int>(seed % 12), free_base);
            scene.name += std::to_string(seed) + (free_base ? " in flight" : "");
            expect_alike(scene);
        }
}

/// Makes some bodies of the tree massless, points or rods. Returns whether the mass matrix is regular.
bool lighten(Scene& scene, unsigned seed) {
    Dice dice(seed + 2000);
    for (NamedBody& named : scene.bodies) {
        Body& body = named.body;
        const double kind = dice.number();
        if (kind < -0.5)
            body.mass = 0, body.inertia_B = {};
        else if (kind < 0)
            body.inertia_B = {};
        else if (kind < 0.5)
            body.inertia_B = diagonal(Vector3<double>(0.5, 0.5, 0));
    }
    try {
        Tree<double>(scene, bodies_mass_properties<double>(scene));
        return true;
    } catch (const InputError&) {
        return false;
    }
}

TEST(Tree, MovesBodiesWithoutMassPointsAndRodsAsMultipliersDo) {
    int regular = 0, loaded = 0;
    for (unsigned seed = 0; seed < 400; ++seed) {
        Scene scene = loaded_tree(seed, 2 + static_cast<int>(seed % 7), seed % 3 == 0);
        if (!lighten(scene, seed)) continue;
        ++regular;
        for (const NamedBody& body : scene.bodies) loaded += body.body.mass == 0;
        if (seed % 2 == 0) scene.loads.push_back(Impulse{{1, -2, 0.5}, Frame::world, {}, Frame::body, 0, "b1"});
        scene.name += std::to_string(seed) + " with light bodies";
        expect_alike(scene);
    }
    EXPECT_GE(regular, 60);
    EXPECT_GE(loaded, 40);
}

TEST(Tree, ImpulsesGoThroughAllJoints) {
    for (unsigned seed = 0; seed < 20; ++seed) {
        Scene scene = random_tree(seed, 6, seed % 2 == 0);
        Dice dice(seed + 77);
        for (const Frame frame : {Frame::body, Frame::world})
            scene.loads.push_back(
                Impulse{dice.vector(), frame, dice.vector(), frame, 0, frame == Frame::body ? "b5" : "b2"});
        scene.name += std::to_string(seed) + " struck";
        expect_alike(scene);
    }
}

// theta'' = -m g l sin(theta) / (I + m l^2)
TEST(Tree, AcceleratesAPendulumAsTheBookSays) {
    Scene scene;
    scene.name = "pendulum", scene.duration = 1;
    NamedBody rod;
    rod.name = "rod";
    rod.body.mass = 2, rod.body.inertia_B = diagonal(Vector3<double>(0.5, 0.75, 0.25));
    rod.body.center_of_mass = {0, 0, -1.5};
    scene.bodies.push_back(rod);
    Joint hinge;
    hinge.name = "hinge", hinge.child = "rod", hinge.axes[0] = {0, 1, 0}, hinge.coordinate[0] = 0.75;
    scene.joints.push_back(hinge);
    scene.loads.push_back(Gravity{{0, 0, -9.75}, {}});
    Tree<double> tree(scene, bodies_mass_properties<double>(scene));
    tree.set_loads(scene, 0);
    double y[2], dy[2];
    tree.initial(y);
    tree.derivative(y, dy);
    EXPECT_NEAR(dy[1], -2 * 9.75 * 1.5 * std::sin(0.75) / (0.75 + 2 * 1.5 * 1.5), 1e-14);
    EXPECT_EQ(dy[0], 0);
}

// Cost and memory are linear in the number of bodies: each spherical joint of a chain adds the same number of nodes.
TEST(Tree, TapeIsLinearInTheBodies) {
    const auto nodes = [](int count) {
        Scene scene = random_tree(3, 1, false);
        for (int i = 1; i < count; ++i) {
            scene.bodies.push_back(scene.bodies[0]);
            scene.bodies.back().name = "b" + std::to_string(i);
            Joint joint = scene.joints[0];
            joint.type = JointType::spherical, joint.name = "to " + scene.bodies.back().name;
            joint.parent = "b" + std::to_string(i - 1), joint.child = scene.bodies.back().name;
            scene.joints.push_back(joint);
        }
        Tree<double> tree(scene, bodies_mass_properties<double>(scene));
        tree.set_loads(scene, 0);
        return record<double>(tree, tree.dimension()).tape.nodes.size();
    };
    const std::size_t ten = nodes(10), twenty = nodes(20), forty = nodes(40);
    EXPECT_EQ(forty - twenty, 2 * (twenty - ten));
}

}  // namespace
}  // namespace polhode
