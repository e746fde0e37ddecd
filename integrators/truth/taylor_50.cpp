#include "integrators/truth/attempt_taylor.h"

namespace polhode::truth {

template Attempt attempt_by_taylor<50>(const Problem&, const std::vector<double>&, double);

}  // namespace polhode::truth
