// What a method looks like in every picture: its family by colour, its place in the family by mark.
#pragma once

#include "integrators/method.h"

namespace polhode {

struct MethodStyle {
    int color = 0;  ///< index of its Family; figure/curve_style.h has the colours
    /// Its place among methods() of its family; behind them the engines of engines(), and then those of one's own.
    int mark = 0;
};

/// The word of a family: "runge_kutta"; those of no family are "others".
const char* name_of(Family family);

/// The same for a method in each picture, whatever else is in it.
MethodStyle method_style(const Method& method);

}  // namespace polhode
