// The colours, marks and dashes of curves.
#pragma once

#include <string>

#include "figure/figure.h"

namespace polhode {

/// So many colours: a grey, and one for each family of methods in the order of Family (integrators/method.h).
constexpr int color_count = 13;

/// So many marks: six filled, the same six open, three of strokes alone. Beyond them they begin anew with a dash.
constexpr int mark_count = 15;

/// The first of those of strokes.
constexpr int first_stroke_mark = 12;

/// "#rrggbb" of a colour on a white ground, at 3:1 or more against it. Beyond the last they begin anew.
std::string color_of(int color);

/// The same colour for a dark ground (#1b1b1f).
std::string dark_color_of(int color);

/// The ground that dark_color_of() is chosen for.
inline constexpr const char* dark_ground = "#1b1b1f";

/// A mark's name, as pictures in a browser know it: circle, square, triangle-up, diamond, triangle-down, pentagon;
/// circle-open, ..; cross-thin (a plus), x-thin, asterisk.
std::string mark_name(int mark);

/// A mark as gnuplot's point type.
int point_type_of(int mark);

/// gnuplot's dash type of a curve: its dash, and one more each time the marks begin anew.
std::string dash_of(const Curve& curve);

/// How many dashes on a curve's line is drawn, 0 for a solid one.
int dash_index_of(const Curve& curve);

/// What a curve that is of no method looks like: the place-th of its picture.
struct PlainStyle {
    int color = 0;  ///< in an order in which neighbours differ most
    int mark = 0;   ///< the first six in turn
};
PlainStyle plain_style(int place);

/// Gives a curve a colour and a mark: a PlainStyle, or that of a method.
template <class Style>
void set_style(Curve& curve, const Style& style) {
    curve.color = style.color, curve.mark = style.mark;
}

/// "#rrggbb" of a shade of MapClass; beyond the last the last, below the first the first.
std::string color_of_shade(int shade);

}  // namespace polhode
