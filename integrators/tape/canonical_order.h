// One order for a recorded system, whatever order its operations were recorded in.
#pragma once

#include "motion/traced.h"

namespace polhode {

/// The same system with its operations, and the operands of each sum and product, in an order that hangs on what they
/// are alone. C++ leaves it to the compiler which operand of an operator is computed first, and so which is recorded
/// first: of products that are added by fused operations, which are rounded differently, each compiler would have its
/// own first one.
Recording<double> in_canonical_order(const Recording<double>& recording);

}  // namespace polhode
