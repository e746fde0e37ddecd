// Applicability of the method `exact`.
#pragma once

#include "motion/problem.h"

namespace polhode {

/// Returns whether the posed motion has a closed form on every piece between its events.
bool has_closed_form(const Problem& problem);

}  // namespace polhode
