#include "integrators/truth/attempt_joints.h"

namespace polhode::truth {

template Attempt attempt_by_joint_events<100>(const Problem&, const std::vector<double>&, double);

}  // namespace polhode::truth
