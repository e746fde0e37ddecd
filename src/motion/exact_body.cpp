#include "motion/exact_body_of.h"

namespace polhode {

template ExactBody<double> exact_body(const Scene& scene);
template ExactBody<Wide> exact_body(const Scene& scene);

}  // namespace polhode
