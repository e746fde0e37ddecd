// The polhode curve, its visible part and its figures, compared with the geometry of ellipsoids.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "app/polhode_picture.h"
#include "app/polhode_view.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

using V = Vector3<double>;

double length(const V& v) { return std::hypot(v[0], v[1], v[2]); }
double twice_energy(const V& I, const V& w) { return I[0] * w[0] * w[0] + I[1] * w[1] * w[1] + I[2] * w[2] * w[2]; }
double momentum(const V& I, const V& w) { return length({I[0] * w[0], I[1] * w[1], I[2] * w[2]}); }

PolhodeCurve curve_of(const char* name) { return polhode_curve(pose(find_scene(name))); }

TEST(PolhodeCurve, OfAFreeBodyIsWhereEnergyAndMomentumMeet) {
    for (const char* name : {"free_asymmetric", "near_separatrix", "toutatis", "box_with_sphere", "symmetric"}) {
        SCOPED_TRACE(name);
        const PolhodeCurve polhode = curve_of(name);
        ASSERT_EQ(polhode.fault, "");
        EXPECT_TRUE(polhode.free);
        EXPECT_TRUE(polhode.energy_of_start);
        ASSERT_EQ(polhode.curve.size(), 1u);
        const V& I = polhode.moments;
        const double L = momentum(I, polhode.curve[0][0]);
        for (const V& w : polhode.curve[0]) {
            EXPECT_NEAR(twice_energy(I, w) / (2 * polhode.energy), 1, 1e-8);
            EXPECT_NEAR(momentum(I, w) / L, 1, 1e-8);
        }
        for (int i = 0; i < 3; ++i)
            EXPECT_NEAR(I[i] * polhode.semi_axes[i] * polhode.semi_axes[i], 2 * polhode.energy, 1e-12 * polhode.energy);
    }
}

TEST(PolhodeCurve, EndsOnceRound) {
    // I = (1, 1, 0.5): w rotates about the axis at w3 (I3 - I1)/I1 = -1 rad/s; samples are T / 8192 apart
    const PolhodeCurve symmetric = curve_of("symmetric");
    EXPECT_TRUE(symmetric.closed);
    EXPECT_NEAR(symmetric.until, 2 * std::numbers::pi, 100.0 / 8192);
    EXPECT_EQ(symmetric.curve[0].front(), symmetric.curve[0].back());
    // 5.41 days, as published
    const PolhodeCurve toutatis = curve_of("toutatis");
    EXPECT_TRUE(toutatis.closed);
    EXPECT_NEAR(toutatis.until / 86400, 5.41, 30.0 / 8192);
    EXPECT_FALSE(curve_of("separatrix").closed);
    EXPECT_FALSE(curve_of("lagrange_top").closed);
}

TEST(PolhodeCurve, SeparatrixHasTheMomentumOfTheMiddleAxis) {
    const PolhodeCurve polhode = curve_of("near_separatrix");
    ASSERT_EQ(polhode.separatrix.size(), 2u);
    for (const Polyline& ellipse : polhode.separatrix)
        for (const V& w : ellipse) {
            // L^2 = 2 E I2
            EXPECT_NEAR(twice_energy(polhode.moments, w), 2 * polhode.energy, 1e-13 * polhode.energy);
            EXPECT_NEAR(std::pow(momentum(polhode.moments, w), 2), 2 * polhode.energy * 4, 1e-12 * polhode.energy);
        }
    // the motion of the scene stays within about 1e-3 of it
    double nearest = 1;
    for (const V& w : polhode.separatrix[0]) nearest = std::min(nearest, length(w - polhode.curve[0][0]));
    EXPECT_LT(nearest, 0.1);
    EXPECT_TRUE(curve_of("symmetric").separatrix.empty());
    EXPECT_TRUE(curve_of("heavy_asymmetric_top").separatrix.empty());
}

TEST(PolhodeCurve, BreaksAtAnImpulseAndTakesTheLargestEnergyOfABodyStartedAtRest) {
    const PolhodeCurve bar = curve_of("struck_bar");
    EXPECT_FALSE(bar.free);
    EXPECT_FALSE(bar.energy_of_start);
    ASSERT_EQ(bar.curve.size(), 2u);
    EXPECT_EQ(bar.curve[0].back(), V());
    EXPECT_NEAR(bar.curve[1].front()[1], -1, 1e-15);
    EXPECT_NEAR(bar.energy, 0.16708333333333333 / 2, 1e-15);
    EXPECT_EQ(curve_of("at_rest").energy, 0);
}

RC_GTEST_PROP(Simplified, KeepsEndsAndLeavesOutOnlyWhatIsClose, (std::uint64_t seed)) {
    std::uint64_t state = seed;
    const auto random = [&] {
        state = state * 6364136223846793005u + 1442695040888963407u;
        return static_cast<double>(state >> 11) * 0x1p-53 - 0.5;
    };
    Polyline line{{random(), random(), random()}};
    const auto count = *rc::gen::inRange(0, 60);
    for (int i = 0; i < count; ++i) line.push_back(line.back() + 0.2 * V(random(), random(), random()));
    const V scale(1, 2, 0.5);
    const double tolerance = 0.1;
    const Polyline kept = simplify(line, scale, tolerance);
    RC_ASSERT(kept.front() == line.front());
    RC_ASSERT(kept.back() == line.back());
    // every point is within the tolerance of the segment that replaced it
    std::size_t piece = 0;
    for (const V& p : line) {
        if (piece + 1 < kept.size() && p == kept[piece + 1]) ++piece;
        const V from = kept[piece], to = kept[std::min(piece + 1, kept.size() - 1)];
        double nearest = 1e9;
        for (int k = 0; k <= 1000; ++k) {
            const V d = p - (from + (k / 1000.0) * (to - from));
            nearest = std::min(nearest, length({d[0] / scale[0], d[1] / scale[1], d[2] / scale[2]}));
        }
        RC_ASSERT(nearest < tolerance * 1.01);
    }
}

PolhodeCurve ellipsoid(const V& semi_axes) {
    PolhodeCurve polhode;
    polhode.semi_axes = semi_axes;
    polhode.energy = 0.5;
    for (int i = 0; i < 3; ++i) polhode.moments[i] = 1 / (semi_axes[i] * semi_axes[i]);
    return polhode;
}

TEST(PolhodeView, DistinguishesFrontAndBack) {
    const PolhodeView view(ellipsoid({3, 2, 1.5}), {0, 0, 1}, {1, 0, 0});
    EXPECT_FALSE(view.hidden({0, 0, 1.5}));
    EXPECT_TRUE(view.hidden({0, 0, -1.5}));
    EXPECT_TRUE(view.hidden({0, 0, 0})) << "inside";
    EXPECT_TRUE(view.hidden({0, 0, 1})) << "inside, near";
    EXPECT_FALSE(view.hidden({0, 0, 9})) << "in front of it";
    EXPECT_TRUE(view.hidden({2, 0.5, -9})) << "far behind it";
    EXPECT_FALSE(view.hidden({3.1, 0, -9})) << "beside it";
    // to scale, the longest semi-axis 1
    EXPECT_NEAR(view.at({3, 2, 1.5}).x, 1, 1e-15);
    EXPECT_NEAR(view.at({3, 2, 1.5}).y, 2.0 / 3, 1e-15);
}

TEST(PolhodeView, OutlineIsTheEllipseOfTheProjection) {
    // seen along axis 1 of an ellipsoid (3, 2, 1.5): semi-axes 2/3 to the right and 1.5/3 up
    const PolhodeView view(ellipsoid({3, 2, 1.5}), {1, 0, 0}, {0, 1, 0});
    for (const PagePoint& p : view.outline()) EXPECT_NEAR(std::hypot(p.x / (2.0 / 3), p.y / 0.5), 1, 1e-14);
}

TEST(PolhodeView, SplitsAnEquatorInHalves) {
    const PolhodeView view(ellipsoid({1, 1, 1}), {1, 0, 0}, {0, 1, 0});
    Polyline equator;
    for (int k = 0; k <= 360; ++k)
        equator.push_back({std::cos(k * std::numbers::pi / 180), std::sin(k * std::numbers::pi / 180), 0});
    const VisibleLine seen = view.seen(equator);
    std::size_t front = 0, behind = 0;
    for (const auto& part : seen.front) front += part.size();
    for (const auto& part : seen.behind) behind += part.size();
    EXPECT_NEAR(static_cast<double>(front), 180, 8);
    EXPECT_NEAR(static_cast<double>(behind), 180, 8);
}

TEST(PolhodeView, DrawsThinEllipsoidsThreeToOne) {
    const V thin = drawn_semi_axes({100, 1, 10}), plain = drawn_semi_axes({2, 1, 1.5});
    EXPECT_NEAR(thin[0], 1, 1e-15);
    EXPECT_NEAR(thin[1], 1.0 / 3, 1e-15);
    EXPECT_NEAR(thin[2], 1 / std::sqrt(3.0), 1e-15);
    EXPECT_EQ(plain, V(1, 0.5, 0.75));
}

TEST(PolhodeText, FitsATerminalAndMarksTheStartInBothViews) {
    for (const char* name : {"free_asymmetric", "explorer_1", "sphere", "lagrange_top", "chaotic_top", "struck_bar"}) {
        SCOPED_TRACE(name);
        const PolhodeCurve polhode = curve_of(name);
        ASSERT_EQ(polhode.fault, "");
        const std::vector<std::string> drawing = polhode_text(polhode);
        ASSERT_EQ(drawing.size(), 18u);
        long starts = 0;
        for (std::size_t i = 1; i < drawing.size(); ++i) {
            starts += std::count(drawing[i].begin(), drawing[i].end(), 'o');
            const auto continues = [](char c) { return (static_cast<unsigned char>(c) & 0xc0) == 0x80; };
            EXPECT_LE(drawing[i].size() - std::count_if(drawing[i].begin(), drawing[i].end(), continues), 78u);
        }
        EXPECT_EQ(starts, 2);
    }
}

TEST(PolhodeScript, ShowsTitlesLiterally) {
    const std::string script = polhode_script(curve_of("free_asymmetric"), "a`b\" \\n {c}_2\n", "svg");
    EXPECT_NE(script.find("\"a\\140b\\042 \\134n {c}_2 \""), std::string::npos);
    EXPECT_THROW(polhode_script(curve_of("free_asymmetric"), "", "png"), std::invalid_argument);
}

}  // namespace
}  // namespace polhode
