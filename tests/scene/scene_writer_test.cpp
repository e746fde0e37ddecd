#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <fstream>
#include <limits>
#include <sstream>

#include "places.h"
#include "scene/random_scene.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

bool same(const Window& a, const Window& b) { return a.from == b.from && a.until == b.until; }

bool same(const Load& a, const Load& b) {
    if (a.index() != b.index() || !same(window_of(a), window_of(b))) return false;
    if (const auto* one = std::get_if<Gravity>(&a)) return one->acceleration_W == std::get<Gravity>(b).acceleration_W;
    if (const auto* one = std::get_if<Torque>(&a))
        return one->vector == std::get<Torque>(b).vector && one->frame == std::get<Torque>(b).frame;
    if (const auto* one = std::get_if<Force>(&a)) {
        const Force& two = std::get<Force>(b);
        return one->vector == two.vector && one->frame == two.frame && one->point == two.point &&
               one->point_frame == two.point_frame;
    }
    if (const auto* one = std::get_if<Impulse>(&a)) {
        const Impulse& two = std::get<Impulse>(b);
        return one->vector == two.vector && one->frame == two.frame && one->point == two.point &&
               one->point_frame == two.point_frame && one->at == two.at;
    }
    if (const auto* one = std::get_if<Drag>(&a))
        return one->rotational == std::get<Drag>(b).rotational && one->translational == std::get<Drag>(b).translational;
    const Spring &one = std::get<Spring>(a), &two = std::get<Spring>(b);
    return one.stiffness == two.stiffness && one.rest_orientation == two.rest_orientation;
}

RC_GTEST_PROP(WriteScene, ReadsBackToTheSameScene, ()) {
    const Scene a = random_scene();
    const std::string text = write_scene(a);
    const Scene b = parse_scene(text, "written");
    RC_ASSERT(a.name == b.name);
    RC_ASSERT(a.about == b.about);
    RC_ASSERT(a.source == b.source);
    RC_ASSERT(a.duration == b.duration);
    RC_ASSERT(a.body.mass == b.body.mass);
    RC_ASSERT(a.body.inertia_B == b.body.inertia_B);
    RC_ASSERT(a.body.center_of_mass == b.body.center_of_mass);
    RC_ASSERT(a.initial.orientation == b.initial.orientation);
    RC_ASSERT(a.initial.angular_velocity == b.initial.angular_velocity);
    RC_ASSERT(a.initial.angular_velocity_frame == b.initial.angular_velocity_frame);
    RC_ASSERT(a.initial.position_W == b.initial.position_W);
    RC_ASSERT(a.initial.velocity_W == b.initial.velocity_W);
    RC_ASSERT(a.pivot == b.pivot);
    RC_ASSERT(a.tolerated == b.tolerated);
    RC_ASSERT(a.loads.size() == b.loads.size());
    for (std::size_t i = 0; i < a.loads.size(); ++i) RC_ASSERT(same(a.loads[i], b.loads[i]));
    // canonical: a scene has one text
    RC_ASSERT(write_scene(b) == text);
}

TEST(WriteScene, WritesTheGoldenFile) {
    Scene s;
    s.name = "golden \"top\"";
    s.about = "tab\tand line\nand \x7f";
    s.source = "é";
    s.duration = 0.1;
    s.body.mass = 1e22;
    s.body.inertia_B = {{Vector3<double>(2, 0.1, 0), Vector3<double>(0.1, 2, -0.0), Vector3<double>(0, 0, 2.5)}};
    s.body.center_of_mass = {1e-7, 1.0 / 3, -0.0};
    s.initial.orientation = {0.9689124217106447, 0.24740395925452294, 0, 0};
    s.initial.angular_velocity_frame = Frame::world;
    s.pivot = Vector3<double>(0, 0, 0.5);
    const Window window{1, 2.5};
    s.loads = {Gravity{{0, 0, -9.80665}, window},
               Torque{{1, 2, 3}, Frame::body, {}},
               Force{{1, 2, 3}, Frame::world, {4, 5, 6}, Frame::body, {-1e300, 5}},
               Impulse{{1, 0, 0}, Frame::body, {0, 0, 1}, Frame::world, 1.5},
               Drag{{0.1, 0.2, 0.3}, 5e-324, {}},
               Spring{10, {}, {}}};
    s.tolerated = {{"attitude", 1e-3}};
    std::ifstream file(source_dir() + "/tests/scene/golden_scene.json");
    std::stringstream golden;
    golden << file.rdbuf();
    EXPECT_EQ(write_scene(s), golden.str());
}

TEST(WriteScene, MomentsAreThreeNumbersWhereNothingStandsOffTheDiagonal) {
    Scene s;
    s.name = "s", s.duration = 1;
    EXPECT_NE(write_scene(s).find("\"inertia\": [1, 1, 1]"), std::string::npos);
    s.body.inertia_B[0][1] = s.body.inertia_B[1][0] = 0.25;
    EXPECT_NE(write_scene(s).find("\"inertia\": [[1, 0.25, 0], [0.25, 1, 0], [0, 0, 1]]"), std::string::npos);
}

TEST(WriteScene, RefusesATorqueOfTheUsersOwn) {
    Scene s;
    s.name = "s", s.duration = 1;
    s.loads.push_back(UserTorque{"mine", [](const LoadState&) { return Vector3<double>(); }, {}});
    EXPECT_THROW(write_scene(s), std::invalid_argument);
}

}  // namespace
}  // namespace polhode
