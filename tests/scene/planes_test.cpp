// Planes in scene files: reading, writing, and the check that the body starts on the right side.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "scene/plane_file.h"
#include "scene/random_scene.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

std::string with_planes(const std::string& planes, const std::string& position = "[0, 0, 2]") {
    return R"({"name": "ball", "duration": 1, "body": {"shape": {"type": "sphere", "radius": 0.5}, "mass": 1},
               "initial": {"position": )" +
           position + R"(}, "planes": )" + planes + "}";
}

TEST(Planes, AreReadWithTheirDefaults) {
    const Scene scene = parse_scene(with_planes(R"([{"normal": [0, 3, 4], "restitution": 0.25},
        {"normal": [0, 0, 1], "offset": -1, "restitution": 1, "friction": 0.5}])"),
                                    "test");
    ASSERT_EQ(scene.planes.size(), 2U);
    EXPECT_EQ(scene.planes[0].normal_W, Vector3<double>(0, 3, 4));
    EXPECT_EQ(scene.planes[0].offset, 0);
    EXPECT_EQ(scene.planes[0].restitution, 0.25);
    EXPECT_EQ(scene.planes[0].friction, 0);
    EXPECT_EQ(scene.planes[1].offset, -1);
    EXPECT_EQ(scene.planes[1].friction, 0.5);
}

TEST(Planes, HaveContactCoefficientsAndNames) {
    const Scene scene = parse_scene(with_planes(R"([{"normal": [0, 0, 1], "restitution": 0.25, "name": "floor",
        "torsional_friction": 0.001, "rolling_friction": 0.002, "restitution_law": "poisson"},
        {"normal": [0, 0, 1], "offset": -1, "restitution": 1}])"),
                                    "test");
    EXPECT_EQ(scene.planes[0].torsional_friction, 0.001);
    EXPECT_EQ(scene.planes[0].rolling_friction, 0.002);
    EXPECT_EQ(scene.planes[0].restitution_law, RestitutionLaw::poisson);
    EXPECT_EQ(scene.planes[1].restitution_law, RestitutionLaw::stronge);
    EXPECT_EQ(plane_name(scene, 0), "floor");
    EXPECT_EQ(plane_name(scene, 1), "plane 2");
    const std::string text = write_scene(scene);
    EXPECT_EQ(write_scene(parse_scene(text, "written")), text);
    EXPECT_NE(text.find(R"("restitution_law": "poisson", "name": "floor")"), std::string::npos);
    EXPECT_EQ(text.find("stronge"), std::string::npos);
}

/// A body may touch a plane at the start, up to rounding.
TEST(Planes, MayBeTouchedAtTheStart) {
    const std::string floor = R"([{"normal": [0, 0, 1], "restitution": 1}])";
    EXPECT_NO_THROW(parse_scene(with_planes(floor, "[0, 0, 0.5]"), "test"));
    EXPECT_NO_THROW(parse_scene(with_planes(floor, "[0, 0, 0.49999999999999994]"), "test"));
    EXPECT_THROW(parse_scene(with_planes(floor, "[0, 0, 0.499999]"), "test"), InputError);
    // the condition is 2 z > 1, whatever the length of the normal
    EXPECT_NO_THROW(
        parse_scene(with_planes(R"([{"normal": [0, 0, 2], "offset": 1, "restitution": 1}])", "[0, 0, 1]"), "t"));
    EXPECT_THROW(
        parse_scene(with_planes(R"([{"normal": [0, 0, 2], "offset": 1.1, "restitution": 1}])", "[0, 0, 1]"), "t"),
        InputError);
}

/// For a rotated box the lowest corner counts, for parts their common hull.
TEST(Planes, AreHeldAgainstTheTurnedBody) {
    const auto scene = [](const char* body, const char* height) {
        return std::string(R"({"name": "box", "duration": 1, "body": )") + body +
               R"(, "initial": {"orientation": [0.9238795325112867, 0.3826834323650898, 0, 0], "position": [0, 0, )" +
               height + R"(]}, "planes": [{"normal": [0, 0, 1], "restitution": 1}]})";
    };
    // an eighth of a rotation about x: the lowest corner is sqrt(2) below the centre
    const char* box = R"({"shape": {"type": "box", "half_extents": [1, 1, 1]}, "mass": 1})";
    EXPECT_NO_THROW(parse_scene(scene(box, "1.4143"), "test"));
    EXPECT_THROW(parse_scene(scene(box, "1.4142"), "test"), InputError);
    const char* parts = R"({"parts": [
        {"shape": {"type": "box", "half_extents": [1, 1, 1]}, "density": 1, "position": [5, 0, 0]},
        {"shape": {"type": "sphere", "radius": 2}, "density": -0.001, "position": [5, 0, 0]}]})";
    EXPECT_NO_THROW(parse_scene(scene(parts, "1.4143"), "test"));
    EXPECT_THROW(parse_scene(scene(parts, "1.4142"), "test"), InputError);
}

RC_GTEST_PROP(Planes, ReadBackToTheSamePlanes, ()) {
    Scene scene = parse_scene(with_planes("[]"), "test");
    const int count = *rc::gen::inRange(0, 4);
    for (int i = 0; i < count; ++i) {
        Plane plane;
        plane.normal_W = random_vector();
        if (plane.normal_W == Vector3<double>()) plane.normal_W[0] = 1;
        plane.restitution = *rc::gen::inRange(0, 1001) / 1000.0, plane.friction = std::abs(*real_number());
        // the body is 2 m from the plane, on its positive side
        plane.offset = -3 * (1 + std::sqrt(dot(plane.normal_W, plane.normal_W)));
        plane.offset += dot(plane.normal_W, scene.initial.position_W);
        scene.planes.push_back(plane);
    }
    const std::string text = write_scene(scene);
    const Scene read = parse_scene(text, "written");
    RC_ASSERT(read.planes.size() == scene.planes.size());
    for (std::size_t i = 0; i < scene.planes.size(); ++i) {
        RC_ASSERT(read.planes[i].normal_W == scene.planes[i].normal_W);
        RC_ASSERT(read.planes[i].offset == scene.planes[i].offset);
        RC_ASSERT(read.planes[i].restitution == scene.planes[i].restitution);
        RC_ASSERT(read.planes[i].friction == scene.planes[i].friction);
    }
    RC_ASSERT(write_scene(read) == text);
}

}  // namespace
}  // namespace polhode
