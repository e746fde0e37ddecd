// The palette under simulated colour vision deficiency, its contrast with the background, and the marks of curves.
#include "figure/curve_style.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <string>

namespace polhode {
namespace {

using Triple = std::array<double, 3>;
using Matrix = std::array<Triple, 3>;

Triple times(const Matrix& m, const Triple& v) {
    Triple result{};
    for (std::size_t i = 0; i < 3; ++i) result[i] = m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2];
    return result;
}

constexpr Matrix unchanged{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
// Simulated protanopia and deuteranopia, applied to linear RGB: G. M. Machado, M. M. Oliveira & L. A. F. Fernandes, A
// physiologically-based model for simulation of color vision deficiency, IEEE TVCG 15 (2009), severity 1.
constexpr Matrix protanopia{
    {{0.152286, 1.052583, -0.204868}, {0.114503, 0.786281, 0.099216}, {-0.003882, -0.048116, 1.051998}}};
constexpr Matrix deuteranopia{
    {{0.367322, 0.860646, -0.227968}, {0.280085, 0.672501, 0.047413}, {-0.011820, 0.042940, 0.968881}}};

Triple linear(const std::string& color) {
    Triple result{};
    for (std::size_t i = 0; i < 3; ++i) {
        const double c = std::stoi(color.substr(1 + 2 * i, 2), nullptr, 16) / 255.0;
        result[i] = c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
    }
    return result;
}

double luminance(const std::string& color) {
    const Triple c = linear(color);
    return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
}

// CIE 1976 L*
double lightness(const std::string& color) { return 116 * std::cbrt(luminance(color)) - 16; }

// CIE L*a*b* (D65) from linear RGB
Triple lab(Triple rgb) {
    for (double& c : rgb) c = std::clamp(c, 0.0, 1.0);
    Triple x = times(
        {{{0.4124564, 0.3575761, 0.1804375}, {0.2126729, 0.7151522, 0.0721750}, {0.0193339, 0.1191920, 0.9503041}}},
        rgb);
    x[0] /= 0.95047, x[2] /= 1.08883;
    for (double& t : x) t = t > 216.0 / 24389 ? std::cbrt(t) : (24389.0 / 27 * t + 16) / 116;
    return {116 * x[1] - 16, 500 * (x[0] - x[1]), 200 * (x[1] - x[2])};
}

// CIEDE2000: G. Sharma, W. Wu & E. N. Dalal, Color Res. Appl. 30 (2005), eqs. 2 to 22
double difference(const Triple& one, const Triple& other) {
    constexpr double pi = std::numbers::pi, degree = pi / 180;
    const auto seventh = [](double c) { return std::sqrt(std::pow(c, 7) / (std::pow(c, 7) + std::pow(25.0, 7))); };
    const double G = 0.5 * (1 - seventh((std::hypot(one[1], one[2]) + std::hypot(other[1], other[2])) / 2));
    const double a1 = one[1] * (1 + G), a2 = other[1] * (1 + G);
    const double C1 = std::hypot(a1, one[2]), C2 = std::hypot(a2, other[2]);
    const auto hue = [&](double a, double b) {
        const double h = a == 0 && b == 0 ? 0 : std::atan2(b, a) / degree;
        return h < 0 ? h + 360 : h;
    };
    const double h1 = hue(a1, one[2]), h2 = hue(a2, other[2]);
    const bool grey = C1 * C2 == 0, far = std::abs(h1 - h2) > 180;
    const double dh = grey ? 0 : !far ? h2 - h1 : h2 > h1 ? h2 - h1 - 360 : h2 - h1 + 360;
    const double H = grey ? h1 + h2 : !far ? (h1 + h2) / 2 : h1 + h2 < 360 ? (h1 + h2 + 360) / 2 : (h1 + h2 - 360) / 2;
    const double L = (one[0] + other[0]) / 2, C = (C1 + C2) / 2;
    const double T = 1 - 0.17 * std::cos((H - 30) * degree) + 0.24 * std::cos(2 * H * degree) +
                     0.32 * std::cos((3 * H + 6) * degree) - 0.20 * std::cos((4 * H - 63) * degree);
    const double turn = 30 * std::exp(-std::pow((H - 275) / 25, 2));
    const double dL = (other[0] - one[0]) / (1 + 0.015 * std::pow(L - 50, 2) / std::sqrt(20 + std::pow(L - 50, 2)));
    const double dC = (C2 - C1) / (1 + 0.045 * C);
    const double dH = 2 * std::sqrt(C1 * C2) * std::sin(dh / 2 * degree) / (1 + 0.015 * C * T);
    const double R = -std::sin(2 * turn * degree) * 2 * seventh(C);
    return std::sqrt(dL * dL + dC * dC + dH * dH + R * dC * dH);
}

// three pairs from table 1 of the article
TEST(CurveStyle, MeasuresDifferencesAsTheArticleDoes) {
    EXPECT_NEAR(difference({50, 2.6772, -79.7751}, {50, 0, -82.7485}), 2.0425, 1e-4);
    EXPECT_NEAR(difference({50, 2.5, 0}, {73, 25, -18}), 27.1492, 1e-4);
    EXPECT_NEAR(difference({2.0776, 0.0795, -1.1350}, {0.9033, -0.0636, -0.5514}), 0.9082, 1e-4);
}

double contrast(const std::string& one, const std::string& other) {
    const double a = luminance(one), b = luminance(other);
    return (std::max(a, b) + 0.05) / (std::min(a, b) + 0.05);
}

// The families from closed_form to engine_update share figures. Their least difference is 10.7, where 2.3 is just
// noticeable side by side. Point bodies, the truth and engines seldom appear with them and may be closer.
TEST(CurveStyle, FamiliesDifferToThoseWithoutRedOrGreen) {
    constexpr int first = 1, last_together = 9;
    for (std::string (*const color)(int) : {color_of, dark_color_of})
        for (const auto& [matrix, together] : {std::pair(&unchanged, 14.0), {&protanopia, 10.5}, {&deuteranopia, 10.5}})
            for (int i = first; i < color_count; ++i)
                for (int j = first; j < i; ++j) {
                    const double least = i > last_together ? 7 : together;
                    EXPECT_GT(difference(lab(times(*matrix, linear(color(i)))), lab(times(*matrix, linear(color(j))))),
                              least)
                        << color(i) << " and " << color(j);
                }
}

// WCAG 2.2, 1.4.11: contrast of at least 3:1 for graphics needed to understand the content
TEST(CurveStyle, ColorsStandOutFromTheirGround) {
    for (int i = 0; i < color_count; ++i) {
        EXPECT_GE(contrast(color_of(i), "#ffffff"), 3) << i;
        EXPECT_GE(contrast(dark_color_of(i), dark_ground), 3) << i;
    }
}

TEST(CurveStyle, MarksRepeatWithADash) {
    std::set<std::string> names;
    std::set<int> types;
    for (int i = 0; i < mark_count; ++i) names.insert(mark_name(i)), types.insert(point_type_of(i));
    EXPECT_EQ(names.size(), static_cast<std::size_t>(mark_count));
    EXPECT_EQ(types.size(), static_cast<std::size_t>(mark_count));
    EXPECT_EQ(mark_name(2), "triangle-up");
    EXPECT_EQ(mark_name(7), "square-open");
    EXPECT_EQ(point_type_of(7) + 1, point_type_of(1));  // gnuplot's open and filled squares
    Curve curve;
    curve.mark = mark_count - 1;
    EXPECT_EQ(dash_of(curve), "solid");
    curve.mark = mark_count;
    EXPECT_NE(dash_of(curve), "solid");
    EXPECT_EQ(mark_name(curve.mark), mark_name(0));
    EXPECT_EQ(color_of(-1), color_of(color_count - 1));
}

TEST(CurveStyle, ShadesDarkenByASteadyStep) {
    for (int i = 1; i < shade_count; ++i)
        EXPECT_GT(lightness(color_of_shade(i - 1)) - lightness(color_of_shade(i)), 8) << i;
    EXPECT_EQ(color_of_shade(-1), color_of_shade(0));
    EXPECT_EQ(color_of_shade(shade_count), color_of_shade(shade_count - 1));
}

// twelve colours; further curves differ by their marks
TEST(CurveStyle, PlainCurvesAreDistinguishable) {
    std::set<std::pair<std::string, int>> styles;
    for (int i = 0; i < 48; ++i) {
        Curve curve;
        set_style(curve, plain_style(i));
        styles.insert({color_of(curve.color), curve.mark});
    }
    EXPECT_EQ(styles.size(), 48U);
}

}  // namespace
}  // namespace polhode
