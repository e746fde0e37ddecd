// Reorders the operations of a recorded system so that the result does not depend on the order of recording.
#pragma once

#include "motion/traced.h"

namespace polhode {

/// Returns the same system with its operations, and the operands of each sum and product, in an order that depends
/// only on the operations themselves. C++ leaves the evaluation order of an operator's operands to the compiler, so
/// recordings differ between compilers. Fused multiply-adds round differently in a different order, so results would
/// differ too.
Recording<double> in_canonical_order(const Recording<double>& recording);

}  // namespace polhode
