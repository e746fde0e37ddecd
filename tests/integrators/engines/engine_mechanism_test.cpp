// Requests for mechanisms in the engine protocol, with shell scripts in place of engines.
#include "integrators/engines/engine_mechanism.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "body/orientation.h"
#include "integrators/engines/engine_methods.h"
#include "motion/mechanism.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

using nlohmann::json;

/// The trajectory that an engine consisting of this shell script returns for the scene.
Trajectory scripted(const std::string& script, const Scene& scene) {
    std::string path = (std::filesystem::temp_directory_path() / "polhode-mechanism-XXXXXX").string();
    close(mkstemp(path.data()));
    std::ofstream(path) << json{{"engines", {{{"name", "scripted"}, {"command", {"sh", "-c", script}}}}}};
    const std::vector<EngineMethod> engines = read_engines(path);
    unlink(path.c_str());
    Settings settings;
    settings.step = scene.duration / 4, settings.samples = 1;
    return solve(scene, *engines.front().method, settings);
}

std::string greeting(const std::string& joints, const std::string& loops = "[]") {
    return R"(echo '{"version": "1", "settings": {"default": ""}, "joints": )" + joints + R"(, "loops": )" + loops +
           "}' >&3; ";
}

// A rod of 2 kg with its centre of mass 1 m below a hinge about y, rotated by a quarter rotation and moving.
Scene rod() {
    return parse_scene(R"({"name": "rod", "duration": 1,
      "bodies": [{"name": "rod", "body": {"mass": 2, "inertia": [1, 2, 3], "center_of_mass": [0, 0, -1]}}],
      "joints": [{"name": "hinge", "type": "revolute", "parent": "world", "child": "rod", "parent_point": [0, 0, 5],
                  "axis": [0, 3, 0], "parent_orientation": [1, 0, 0, 0],
                  "initial": {"angle": 1.5707963267948966, "rate": 4}}],
      "loads": [{"type": "gravity", "acceleration": [0, 0, -9.81]}]})",
                       "rod");
}

// By hand: the rod points along -x from (0, 0, 5), and its centre of mass rises.
TEST(EngineMechanism, SendsNumbersInTheRequest) {
    const Scene scene = rod();
    Settings settings;
    settings.samples = 7;
    const json asked = json::parse(mechanism_request(engine_mechanism(pose(scene)), "best", 1, settings, 3));
    EXPECT_EQ(asked.at("setting"), "best");
    EXPECT_EQ(asked.at("samples"), 7);
    EXPECT_EQ(asked.at("steps_per_sample"), 3);
    EXPECT_EQ(asked.at("gravity"), json({0.0, 0.0, -9.81}));
    EXPECT_EQ(asked.at("loops"), json::array());
    const json& body = asked.at("bodies").at(0);
    EXPECT_EQ(body.at("name"), "rod");
    EXPECT_EQ(body.at("mass"), 2.0);
    EXPECT_EQ(body.at("moments"), json({1.0, 2.0, 3.0}));
    const auto near = [](const json& got, std::vector<double> expected) {
        ASSERT_EQ(got.size(), expected.size());
        for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(got.at(i).get<double>(), expected[i], 1e-14);
    };
    near(body.at("q"), {std::sqrt(0.5), 0, std::sqrt(0.5), 0});
    near(body.at("w"), {0, 4, 0});
    near(body.at("p"), {-1, 0, 5});
    near(body.at("v"), {0, 0, 4});
    const json& joint = asked.at("joints").at(0);
    EXPECT_EQ(joint.at("type"), "revolute");
    EXPECT_EQ(joint.at("parent"), -1);
    EXPECT_EQ(joint.at("child"), 0);
    near(joint.at("anchor"), {0, 0, 5}), near(joint.at("parent_point"), {0, 0, 5});
    near(joint.at("child_point"), {0, 0, 1});
    near(joint.at("axes").at(0), {0, 1, 0}), near(joint.at("child_axes").at(0), {0, 1, 0});
    near(joint.at("turning"), {0, 4, 0}), near(joint.at("rates"), {4});
}

// The redundant data of each joint agree: its points coincide, its axes coincide, and its rates add up to the
// relative angular velocity.
TEST(EngineMechanism, AgreesWithItselfOnTheCatalogue) {
    int asked = 0;
    for (const std::string& name : builtin_scene_names()) {
        const Scene scene = find_scene(name);
        if (!is_mechanism(scene) || scene.bodies.size() > 20) continue;
        SCOPED_TRACE(name);
        EngineMechanism known;
        try {
            known = engine_mechanism(pose(scene));
        } catch (const std::invalid_argument&) {
            continue;
        }
        ++asked;
        const auto placed = [&](int index, const Vector3<double>& point) {
            if (index < 0) return point;
            const EngineBody& body = known.bodies[static_cast<std::size_t>(index)];
            return body.p_W + rotate(body.q, point);
        };
        const auto turned = [&](int index, const Vector3<double>& axis) {
            return index < 0 ? axis : rotate(known.bodies[static_cast<std::size_t>(index)].q, axis);
        };
        for (const std::vector<EngineJoint>* list : {&known.joints, &known.loops})
            for (const EngineJoint& joint : *list) {
                SCOPED_TRACE(joint.name);
                EXPECT_LT(hypotenuse(placed(joint.child, joint.child_point) - joint.anchor_W), 1e-12);
                if (joint.type != "distance") {
                    EXPECT_LT(hypotenuse(placed(joint.parent, joint.parent_point) - joint.anchor_W), 1e-8);
                }
                Vector3<double> turning;
                for (std::size_t i = 0; i < joint.axes_W.size(); ++i) {
                    EXPECT_NEAR(hypotenuse(joint.axes_W[i]), 1, 1e-14);
                    EXPECT_LT(hypotenuse(turned(joint.parent, joint.parent_axes[i]) - joint.axes_W[i]), 1e-13);
                    EXPECT_LT(hypotenuse(turned(joint.child, joint.child_axes[i]) - joint.axes_W[i]), 1e-13);
                    if (i < joint.rates.size() && joint.type != "prismatic")
                        turning = turning + joint.rates[i] * joint.axes_W[i];
                }
                if (list == &known.joints && joint.type != "spherical") {
                    EXPECT_LT(hypotenuse(turning - joint.angular_velocity_W), 1e-11 * (1 + hypotenuse(turning)));
                }
            }
    }
    EXPECT_GT(asked, 10);
}

TEST(EngineMechanism, ReportsAnEngineWithoutJoints) {
    const Trajectory silent =
        scripted(R"(echo '{"version": "1", "settings": {"default": ""}}' >&3; read -r request)", rod());
    EXPECT_EQ(silent.status, Status::unsupported);
    EXPECT_EQ(silent.message, "scripted: its driver does not support joints");
    const Trajectory balls = scripted(greeting(R"(["spherical"])") + "read -r request", rod());
    EXPECT_EQ(balls.status, Status::unsupported);
    EXPECT_EQ(balls.message, "scripted: it does not support revolute joints");
    Scene loop = find_scene("mechanisms/four_bar");
    const Trajectory open = scripted(greeting(R"(["revolute"])") + "read -r request", loop);
    EXPECT_EQ(open.status, Status::unsupported);
    EXPECT_EQ(open.message, "scripted: it does not support loops closed by a revolute joint");
}

TEST(EngineMechanism, RefusesSpringsWithoutStartingAnEngine) {
    const Trajectory run = scripted("exit 1", find_scene("mechanisms/ball_joint_arm"));
    EXPECT_EQ(run.status, Status::unsupported);
    EXPECT_EQ(run.message, "the engine protocol does not support springs and dampers of spherical joints");
}

// Two joints on the world, neither at coordinate zero, with every law; the second joint is listed first.
Scene geared() {
    return parse_scene(R"({"name": "geared", "duration": 2,
      "bodies": [{"name": "a", "body": {"mass": 2, "inertia": [1, 1, 1]}},
                 {"name": "b", "body": {"mass": 1, "inertia": [1, 1, 1]}}],
      "joints": [{"name": "slide", "type": "prismatic", "parent": "world", "child": "a", "axis": [1, 0, 0],
                  "initial": {"displacement": 0.5}, "friction": 3, "limits": {"lower": 0.25, "restitution": 0.5},
                  "stiffness": 8, "rest": 1, "damping": 0.125},
                 {"name": "hinge", "type": "revolute", "parent": "world", "child": "b", "axis": [0, 1, 0],
                  "initial": {"angle": 1}, "armature": 0.75}],
      "couplings": [{"first": "slide", "second": "hinge", "ratio": 4, "offset": -1}],
      "loads": [{"type": "motor", "joint": "hinge", "torque": -5, "from": 1},
                {"type": "motor", "joint": "slide", "force": 6, "until": 1.5}]})",
                       "geared");
}

// By hand: the coordinates in the request are zero at t = 0, so limits and rest are moved by 0.5 m.
TEST(EngineMechanism, SendsTheLawsOfJoints) {
    const EngineMechanism mechanism = engine_mechanism(pose(geared()));
    const json asked = json::parse(mechanism_request(mechanism, "best", 2, {}, 3));
    const json &slide = asked.at("joints").at(0), &hinge = asked.at("joints").at(1);
    EXPECT_EQ(slide.at("limits"), json({{"lower", -0.25}, {"upper", nullptr}, {"restitution", 0.5}}));
    EXPECT_EQ(slide.at("friction"), 3.0);
    EXPECT_EQ(slide.at("stiffness"), 8.0);
    EXPECT_EQ(slide.at("rest"), 0.5);
    EXPECT_EQ(slide.at("damping"), 0.125);
    EXPECT_FALSE(slide.contains("armature"));
    EXPECT_EQ(hinge.at("armature"), 0.75);
    for (const char* key : {"limits", "friction", "stiffness", "rest", "damping"})
        EXPECT_FALSE(hinge.contains(key)) << key;
    EXPECT_EQ(asked.at("couplings"), json::array({{{"first", 0}, {"second", 1}, {"ratio", 4.0}}}));
    EXPECT_EQ(asked.at("motors"), json::array({{{"joint", 1}, {"force", -5.0}, {"from", 1.0}},
                                               {{"joint", 0}, {"force", 6.0}, {"from", 0.0}, {"until", 1.5}}}));
    EXPECT_EQ(joint_laws(mechanism), (std::vector<std::string>{"limits", "restitution", "friction", "armature",
                                                               "springs", "motors", "couplings"}));
    // a request without laws is unchanged
    const json plain = json::parse(mechanism_request(engine_mechanism(pose(rod())), "best", 1, {}, 3));
    EXPECT_FALSE(plain.contains("motors") || plain.contains("couplings"));
    EXPECT_FALSE(plain.at("joints").at(0).contains("limits"));
}

// The message names the first law that the engine's hello lacks.
TEST(EngineMechanism, RefusesTheLawThatAnEngineLacks) {
    const std::pair<const char*, const char*> steps[] = {
        {R"([])", "limits of joints"},
        {R"(["limits"])", "restitution at the limits of joints"},
        {R"(["limits", "restitution"])", "friction of joints"},
        {R"(["limits", "restitution", "friction"])", "armature of joints"},
        {R"(["limits", "restitution", "friction", "armature"])", "springs and dampers of joints"},
        {R"(["limits", "restitution", "friction", "armature", "springs"])", "motors of joints"},
        {R"(["limits", "restitution", "friction", "armature", "springs", "motors"])", "couplings of joints"}};
    for (const auto& [laws, missing] : steps) {
        const Trajectory run = scripted(
            R"(echo '{"version": "1", "settings": {"default": ""}, "joints": ["revolute", "prismatic"], "laws": )" +
                std::string(laws) + "}' >&3; read -r request",
            geared());
        EXPECT_EQ(run.status, Status::unsupported);
        EXPECT_EQ(run.message, "scripted: it does not support " + std::string(missing));
    }
}

TEST(EngineMechanism, RefusesPrescribedMotions) {
    const Trajectory run = scripted("exit 1", find_scene("joints/bead_on_rotating_rod"));
    EXPECT_EQ(run.status, Status::unsupported);
    EXPECT_EQ(run.message, "the engine protocol does not support prescribed motions of joints");
}

TEST(EngineMechanism, AnAnswerHasAllBodiesAtEachTime) {
    const std::string row = "[1, 0, 0, 0, 0, 2, 0, 1, 2, 3, 4, 5, 6]";
    const auto answer = [&](const std::string& samples) {
        return scripted(greeting(R"(["revolute"])") + "read -r request; echo '" +
                            R"({"status": "ok", "seconds": 0.5, "steps": 4, "samples": )" + samples +
                            "}' >&3; read -r x",
                        rod());
    };
    const Trajectory run = answer("[[" + row + "], [" + row + "]]");
    ASSERT_EQ(run.status, Status::ok) << run.message;
    EXPECT_EQ(run.moments(), 2u);
    EXPECT_EQ(run.steps, 4);
    EXPECT_EQ(run.samples[1].t, 1);
    EXPECT_EQ(run.samples[1].position_W, Vector3<double>(1, 2, 3));
    EXPECT_EQ(run.samples[1].angular_velocity_B, Vector3<double>(0, 2, 0));
    const Trajectory two = answer("[[" + row + "," + row + "], [" + row + "]]");
    EXPECT_EQ(two.status, Status::failed);
    EXPECT_NE(two.message.find("2 bodies instead of 1"), std::string::npos) << two.message;
    const Trajectory short_one = answer("[[" + row + "]]");
    EXPECT_EQ(short_one.status, Status::failed);
    EXPECT_NE(short_one.message.find("1 samples instead of 2"), std::string::npos) << short_one.message;
}

}  // namespace
}  // namespace polhode
