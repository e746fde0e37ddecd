#include "integrators/truth/attempt_collocation.h"

namespace polhode::truth {

template Attempt attempt_by_collocation<100>(const Problem&, const std::vector<double>&, double);

}  // namespace polhode::truth
