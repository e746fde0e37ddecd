#include "integrators/truth/attempt_spheres.h"

namespace polhode::truth {

template Attempt attempt_by_sphere_contacts<50>(const Problem&, const std::vector<double>&, double);

}  // namespace polhode::truth
