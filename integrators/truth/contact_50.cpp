#include "integrators/truth/attempt_contact.h"

namespace polhode::truth {

template Attempt attempt_by_contact_modes<50>(const Problem&, const std::vector<double>&, double);

}  // namespace polhode::truth
