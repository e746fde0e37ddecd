// The style of a method in all figures: colour by family, mark by position in the family.
#pragma once

#include "integrators/method.h"

namespace polhode {

struct MethodStyle {
    int color = 0;  ///< index of its Family; figure/curve_style.h has the colours
    /// Position in the family: methods() first, then engines(), then user-defined methods.
    int mark = 0;
};

/// The name of a family, such as "runge_kutta"; "others" for Family::unnamed.
const char* name_of(Family family);

/// The style of a method. It does not depend on the other methods of a figure.
MethodStyle method_style(const Method& method);

}  // namespace polhode
