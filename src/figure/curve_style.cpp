#include "figure/curve_style.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace polhode {

namespace {

/// Sixteen colours on white. The first eight are told apart by the colour-blind: Okabe & Ito 2008 without its yellow,
/// with black and a brown; the others lie between them, and their markers differ from those of their neighbours.
constexpr std::array<const char*, palette_size> palette = {
    "#0072b2", "#d55e00", "#009e73", "#000000", "#cc79a7", "#e69f00", "#56b4e9", "#7f4f24",
    "#c1121f", "#8a8a8a", "#6a3d9a", "#808000", "#17becf", "#ff8fab", "#1b4d3e", "#9acd32"};
/// gnuplot's circle, square, triangle, diamond, inverted triangle, pentagon: filled; the open one is one less.
constexpr std::array<int, 6> filled_markers = {7, 5, 9, 13, 11, 15};

constexpr std::array<const char*, 5> dashes = {"solid", "(12,6)", "(3,4)", "(12,5,3,5)", "(22,6)"};

/// Lightness L* falls from 96 to 11 by 8 and more a step; neighbours differ in blue against yellow as well.
constexpr std::array<const char*, shade_count> shades = {"#f4f4dc", "#b9e2e6", "#e8b04a", "#6ea3d8",
                                                         "#b8702a", "#46669e", "#7d2a1e", "#1d1a33"};

std::size_t wrapped_index(int index, std::size_t size) {
    const int n = static_cast<int>(size);
    return static_cast<std::size_t>((index % n + n) % n);
}

}  // namespace

std::string color_of(const Curve& curve) { return palette[wrapped_index(curve.color, palette.size())]; }

int marker_of(const Curve& curve) {
    const int colors = static_cast<int>(palette.size());
    const int index = static_cast<int>(wrapped_index(curve.color, palette.size() * filled_markers.size()));
    return filled_markers[wrapped_index(index % colors + index / colors, filled_markers.size())];
}

std::string dash_of(const Curve& curve) { return dashes[wrapped_index(curve.dash, dashes.size())]; }

std::string color_of_shade(int shade) {
    return shades[static_cast<std::size_t>(std::clamp(shade, 0, shade_count - 1))];
}

}  // namespace polhode
