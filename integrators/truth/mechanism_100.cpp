#include "integrators/truth/attempt_mechanism.h"

namespace polhode::truth {

template Attempt attempt_by_mechanism_series<100>(const Problem&, const std::vector<double>&, double);

}  // namespace polhode::truth
