#include "figure/curve_style.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace polhode {

namespace {

struct Color {
    const char *on_white, *on_dark;
};
/// In the order of Family; the first, for curves of no family, is grey. The colours were found by annealing, starting
/// from one hue each. The smallest CIEDE2000 difference of two colours from closed_form to engine_update is 10.7 for
/// protanopia and deuteranopia and 14 for normal vision; for any two families it is 7. Verified by
/// tests/figure/curve_style_test.cpp.
constexpr std::array<Color, color_count> palette = {{{"#7a7a7a", "#9a9a9a"},
                                                     {"#1a1a1a", "#e8e8e8"},
                                                     {"#046cc7", "#68b1ed"},
                                                     {"#d85d00", "#f4740b"},
                                                     {"#138867", "#2fbf8f"},
                                                     {"#b7438c", "#e07bb8"},
                                                     {"#939359", "#d7cd34"},
                                                     {"#5427b5", "#897af0"},
                                                     {"#835d43", "#bf8d5f"},
                                                     {"#c10016", "#c15155"},
                                                     {"#0090a8", "#60c8d8"},
                                                     {"#145555", "#73647d"},
                                                     {"#5d8e23", "#90bf4f"}}};

struct Mark {
    const char* name;
    int point_type;
};
constexpr std::array<Mark, mark_count> marks = {{{"circle", 7},
                                                 {"square", 5},
                                                 {"triangle-up", 9},
                                                 {"diamond", 13},
                                                 {"triangle-down", 11},
                                                 {"pentagon", 15},
                                                 {"circle-open", 6},
                                                 {"square-open", 4},
                                                 {"triangle-up-open", 8},
                                                 {"diamond-open", 12},
                                                 {"triangle-down-open", 10},
                                                 {"pentagon-open", 14},
                                                 {"cross-thin", 1},
                                                 {"x-thin", 2},
                                                 {"asterisk", 3}}};

constexpr std::array<const char*, 5> dashes = {"solid", "(12,6)", "(3,4)", "(12,5,3,5)", "(22,6)"};

/// Blue, orange, green, magenta, red, violet, brown, teal, olive, leaf green, black, grey.
constexpr std::array<int, 12> plain_colors = {2, 3, 4, 5, 9, 7, 8, 10, 6, 12, 1, 0};

/// Lightness L* falls from 96 to 11 in steps of at least 8. Neighbours also differ in blue against yellow.
constexpr std::array<const char*, shade_count> shades = {"#f4f4dc", "#b9e2e6", "#e8b04a", "#6ea3d8",
                                                         "#b8702a", "#46669e", "#7d2a1e", "#1d1a33"};

std::size_t wrapped_index(int index, std::size_t size) {
    const int n = static_cast<int>(size);
    return static_cast<std::size_t>((index % n + n) % n);
}

}  // namespace

std::string color_of(int color) { return palette[wrapped_index(color, palette.size())].on_white; }

std::string dark_color_of(int color) { return palette[wrapped_index(color, palette.size())].on_dark; }

std::string mark_name(int mark) { return marks[wrapped_index(mark, marks.size())].name; }

int point_type_of(int mark) { return marks[wrapped_index(mark, marks.size())].point_type; }

int dash_index_of(const Curve& curve) {
    return static_cast<int>(wrapped_index(curve.dash + std::max(0, curve.mark) / mark_count, dashes.size()));
}

std::string dash_of(const Curve& curve) { return dashes[static_cast<std::size_t>(dash_index_of(curve))]; }

PlainStyle plain_style(int place) {
    const int colors = static_cast<int>(plain_colors.size());
    return {plain_colors[wrapped_index(place, plain_colors.size())],
            static_cast<int>(wrapped_index(place % colors + place / colors, 6))};
}

std::string color_of_shade(int shade) {
    return shades[static_cast<std::size_t>(std::clamp(shade, 0, shade_count - 1))];
}

}  // namespace polhode
