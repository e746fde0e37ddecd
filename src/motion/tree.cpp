#include "motion/tree.h"

namespace polhode {

template class Tree<double>;
POLHODE_TREE_INSTANCES(, double)
POLHODE_TREE_INSTANCES(, Dual<own_directions>)

}  // namespace polhode
