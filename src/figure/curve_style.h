// Colours, marks and dashes of curves.
#pragma once

#include <string>

#include "figure/figure.h"

namespace polhode {

/// Number of colours: grey, and one for each family of methods in the order of Family (integrators/method.h).
constexpr int color_count = 13;

/// Number of marks: six filled, the same six open, three made of strokes. Further curves repeat them with a dash.
constexpr int mark_count = 15;

/// Index of the first mark made of strokes.
constexpr int first_stroke_mark = 12;

/// "#rrggbb" of a colour on a white background, with a contrast of at least 3:1. Indices beyond the last wrap around.
std::string color_of(int color);

/// The same colour for a dark background (#1b1b1f).
std::string dark_color_of(int color);

/// The background for which dark_color_of() is chosen.
inline constexpr const char* dark_ground = "#1b1b1f";

/// A mark's name in browser plots: circle, square, triangle-up, diamond, triangle-down, pentagon; circle-open, ..;
/// cross-thin (a plus), x-thin, asterisk.
std::string mark_name(int mark);

/// The gnuplot point type of a mark.
int point_type_of(int mark);

/// The gnuplot dash type of a curve: its dash index, plus one for every wrap-around of the marks.
std::string dash_of(const Curve& curve);

/// The dash index of a curve's line; 0 is solid.
int dash_index_of(const Curve& curve);

/// The style of a curve that belongs to no method, by its index in the figure.
struct PlainStyle {
    int color = 0;  ///< in an order in which neighbours differ most
    int mark = 0;   ///< cycles through the first six
};
/// The style of the curve with this index.
PlainStyle plain_style(int place);

/// Sets a curve's colour and mark from a PlainStyle or a method's style.
template <class Style>
void set_style(Curve& curve, const Style& style) {
    curve.color = style.color, curve.mark = style.mark;
}

/// "#rrggbb" of a MapClass shade; indices out of range are clamped.
std::string color_of_shade(int shade);

}  // namespace polhode
