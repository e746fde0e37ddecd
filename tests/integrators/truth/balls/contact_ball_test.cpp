// The certified motion of a sphere on planes: the reference in 30 digits and closed forms are inside its balls.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "catalogue.h"
#include "integrators/series/real.h"
#include "integrators/truth/balls/certified.h"
#include "integrators/truth/fresh_cache.h"
#include "integrators/truth/reference.h"
#include "scene/builtin.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

using R = Real<100>;

// Whether the numbers differ by at most both errors.
::testing::AssertionResult agree(const CertifiedNumber& number, const R& other, const R& error) {
    if (abs(R(other - R(number.value))) <= R(number.radius) + error) return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure() << number.value << " +- " << number.radius << " against " << other;
}
std::vector<CertifiedEvent> events_of(const CertifiedReference& truth, const std::string& kind) {
    std::vector<CertifiedEvent> found;
    for (const CertifiedEvent& event : truth.events)
        if (event.kind == kind) found.push_back(event);
    return found;
}

class CertifiedBall : public ::testing::TestWithParam<const char*> {};

/// Two formulations integrated to 30 digits, and the closed forms in balls: every sample and every event time.
TEST_P(CertifiedBall, EnclosesTheReference) {
    const FreshCache cache;
    constexpr int digits = 30;
    constexpr long samples = 16;
    const Scene scene = find_scene(GetParam());
    const CertifiedReference proven = certified_reference(scene, samples, digits);
    ASSERT_TRUE(proven.available) << proven.message;
    EXPECT_GE(proven.digits, digits);
    EXPECT_LE(R(proven.radius), R("1e-25"));
    const DecimalReference truth = decimal_reference(scene, samples, digits);
    ASSERT_TRUE(truth.available) << truth.message;
    ASSERT_EQ(proven.columns.size(), truth.columns.size());
    // the largest speeds, rates and lengths are about 100 in SI units; the bound is relative to them
    const R error = R(truth.bound) * 200;
    for (std::size_t k = 0; k < truth.columns.size(); ++k)
        for (std::size_t c = 0; c < 13; ++c)
            EXPECT_TRUE(agree(proven.columns[k][c], R(truth.columns[k][c]), error)) << k << " " << c;
    for (const std::string kind : {"impact", "accumulates", "rolls"}) {
        const std::vector<CertifiedEvent> found = events_of(proven, kind);
        std::size_t next = 0;
        for (const DecimalContactEvent& event : truth.contact_events)
            if (event.event == kind) {
                ASSERT_LT(next, found.size()) << kind;
                EXPECT_TRUE(agree(found[next++].t, R(event.t), R("1e-28"))) << kind;
            }
        if (kind != "impact") {
            EXPECT_EQ(next, found.size()) << kind;
        }
    }
}
INSTANTIATE_TEST_SUITE_P(Of, CertifiedBall,
                         ::testing::Values("contact/bowling_ball", "contact/ball_incline_rolls",
                                           "contact/ball_incline_slides", "contact/ball_bounces_to_rest",
                                           "contact/ball_bounces_and_rolls", "contact/superball",
                                           "contact/billiard_side_spin"),
                         [](const auto& of) {
                             std::string name = of.param;
                             std::replace(name.begin(), name.end(), '/', '_');
                             return name;
                         });

/// Impacts at 0.5 s and 0.5 + 1 (1 - 2^-k) s, whose limit is 1.5 s exactly; then the ball rests at its radius.
TEST(CertifiedContact, SumsInfinitelyManyImpacts) {
    const CertifiedReference proven = certified_reference(find_scene("contact/ball_bounces_to_rest"), 4, 40);
    ASSERT_TRUE(proven.available) << proven.message;
    const std::vector<CertifiedEvent> impacts = events_of(proven, "impact");
    ASSERT_GT(impacts.size(), 100U);
    EXPECT_TRUE(agree(impacts[0].t, R("0.5"), R(0)));
    EXPECT_TRUE(agree(impacts[1].t, R(1), R(0)));
    EXPECT_TRUE(agree(impacts[2].t, R("1.25"), R(0)));
    const std::vector<CertifiedEvent> limits = events_of(proven, "accumulates");
    ASSERT_EQ(limits.size(), 1U);
    EXPECT_TRUE(agree(limits[0].t, R("1.5"), R(0)));
    EXPECT_TRUE(agree(proven.columns.back()[9], R("0.125"), R(0)));
    EXPECT_TRUE(agree(proven.columns.back()[12], R(0), R(0)));
}

/// The bowling ball slides until t = 2 |u| / (7 mu g).
TEST(CertifiedContact, EnclosesTheEndOfSliding) {
    Scene scene = find_scene("contact/bowling_ball");
    scene.initial.velocity_W = {3.5, 0, 0}, scene.initial.angular_velocity = {};
    scene.loads = {Gravity{{0, 0, -8}, {}}};
    scene.planes[0].friction = 0.125;
    const CertifiedReference proven = certified_reference(scene, 2, 60);
    ASSERT_TRUE(proven.available) << proven.message;
    const std::vector<CertifiedEvent> rolls = events_of(proven, "rolls");
    ASSERT_EQ(rolls.size(), 1U);
    EXPECT_TRUE(agree(rolls[0].t, R(1), R(0)));
    EXPECT_TRUE(agree(proven.columns.back()[10], R("2.5"), R(0)));
    EXPECT_GE(rolls[0].t.digits, 59);
}

/// What has no closed form is refused with the reason.
TEST(CertifiedContact, RefusesOtherContacts) {
    const auto message = [](Scene scene) { return certified_reference(scene, 4, 20, 20).message; };
    EXPECT_NE(message(find_scene("contact/rolling_ellipsoid")).find("uniform spheres"), std::string::npos);
    EXPECT_NE(message(find_scene("contact/ball_in_gutter")).find("two planes at once"), std::string::npos);
    Scene scene = find_scene("contact/ball_incline_rolls");
    scene.planes[0].rolling_friction = 0.001;
    EXPECT_NE(message(scene).find("rolling friction"), std::string::npos);
    scene = find_scene("contact/ball_incline_slides");
    scene.initial.velocity_W = {0, 1, 0};
    EXPECT_NE(message(scene).find("direction changes"), std::string::npos);
    scene.loads.push_back(Torque{{1, 0, 0}, Frame::body, {}});
    EXPECT_NE(message(scene).find("under gravity alone"), std::string::npos);
    // 2/7 tan a = mu exactly
    scene = find_scene("contact/ball_incline_rolls");
    scene.planes[0].friction = 0.25;
    EXPECT_NE(message(scene).find("whether the ball rolls"), std::string::npos) << message(scene);
}

}  // namespace
}  // namespace polhode
