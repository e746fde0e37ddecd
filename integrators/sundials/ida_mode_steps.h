// IDA's steps through the modes of mechanisms with limits, friction and prescribed motions of joints.
#pragma once

#include <memory>

#include "motion/system_steps.h"

namespace polhode {

/// Make steps in maximal coordinates with index 1 or 2. The problem's system is the model of a mode of
/// contact::ConstrainedJointForm.
std::unique_ptr<SystemSteps> make_ida_index1_steps(const Problem& problem, double tolerance);
std::unique_ptr<SystemSteps> make_ida_index2_steps(const Problem& problem, double tolerance);

}  // namespace polhode
