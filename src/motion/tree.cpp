#include "motion/tree.h"

namespace polhode {

template class Tree<double>;
POLHODE_TREE_INSTANCES(, double)
POLHODE_TREE_INSTANCES(, Dual<jacobian_directions>)

}  // namespace polhode
