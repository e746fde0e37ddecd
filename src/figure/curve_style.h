// The colours, markers and dashes of curves, in gnuplot's terms.
#pragma once

#include <string>

#include "figure/figure.h"

namespace polhode {

/// "#rrggbb"
std::string color_of(const Curve& curve);

/// A filled point type; the open one of the same shape is one less. The first sixteen indices differ in colour; the
/// next sixteen have these colours again, each with the next marker.
int marker_of(const Curve& curve);

/// A dash type.
std::string dash_of(const Curve& curve);

/// "#rrggbb" of a shade of MapClass; beyond the last the last, below the first the first.
std::string color_of_shade(int shade);

}  // namespace polhode
