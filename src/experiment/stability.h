// What the study of stability is made of.
#pragma once

#include "experiment/study.h"

namespace polhode {

/// What becomes of a method's order where a torque jumps, or its derivative does, or it acts for less than a step:
/// stepped onto, as an event of the scene, and stepped over, as a function of time that nobody knows to jump. A row for
/// each case, method and way. `quick`: coarser steps and tolerances only.
NamedTable discontinuity_table(bool quick);

}  // namespace polhode
