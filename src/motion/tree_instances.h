// Declares the instances of the recursion in binary64 and dual numbers, which tree.cpp compiles. Without these
// declarations each translation unit would compile copies, and the linker would choose one of an arbitrary
// optimisation level.
#pragma once

#include "motion/dual.h"
#include "motion/tree.h"

namespace polhode {

#define POLHODE_TREE_INSTANCES(EXTERN, S)                                                                         \
    EXTERN template TreeWork<S>& Tree<double>::work<S>() const;                                                   \
    EXTERN template void Tree<double>::derivative(const S*, S*) const;                                            \
    EXTERN template void Tree<double>::accelerate(const S*, TreeWork<S>&, S*) const;                              \
    EXTERN template std::vector<BodyMotion<S>> Tree<double>::motions(const S*) const;                             \
    EXTERN template std::vector<Reaction<S>> Tree<double>::reactions(const Scene&, const S*) const;               \
    EXTERN template std::vector<Reaction<S>> Tree<double>::find_reactions(const Scene&, const S*, TreeWork<S>&,   \
                                                                          const std::vector<BodyLoad<S>>&) const; \
    EXTERN template void Tree<double>::move(const S*, TreeWork<S>&) const;                                        \
    EXTERN template void Tree<double>::compute_frames(const S*, TreeWork<S>&) const;                              \
    EXTERN template void Tree<double>::find_rows(TreeWork<S>&) const;                                             \
    EXTERN template void Tree<double>::load(const S*, TreeWork<S>&) const;                                        \
    EXTERN template Quaternion<S> Tree<double>::attitude_of(std::size_t, const S*, const TreeWork<S>&) const;     \
    EXTERN template void Tree<double>::articulate(TreeWork<S>&) const;                                            \
    EXTERN template void Tree<double>::articulate_with_armature(TreeWork<S>&) const;                              \
    EXTERN template void Tree<double>::compute_accelerations(TreeWork<S>&, S*) const;                             \
    EXTERN template void Tree<double>::compute_accelerations_of<false>(TreeWork<S>&, S*) const;                   \
    EXTERN template void Tree<double>::compute_accelerations_of<true>(TreeWork<S>&, S*) const;                    \
    EXTERN template void Tree<double>::solve_accelerations(TreeWork<S>&, S*) const;                               \
    EXTERN template void Tree<double>::respond(TreeWork<S>&, Pair6<S>*, S*, S*) const;                            \
    EXTERN template void Tree<double>::respond_of<false>(TreeWork<S>&, Pair6<S>*, S*, S*) const;                  \
    EXTERN template void Tree<double>::respond_of<true>(TreeWork<S>&, Pair6<S>*, S*, S*) const;                   \
    EXTERN template void Tree<double>::respond_to_rows(TreeWork<S>&) const;                                       \
    EXTERN template S Tree<double>::applied(std::size_t, const TreeWork<S>&, const Pair6<S>*, const S*) const;    \
    EXTERN template void Tree<double>::add_generalized_force(int, const S&, TreeWork<S>&) const;                  \
    EXTERN template void Tree<double>::start_response(std::size_t, TreeWork<S>&) const;                           \
    EXTERN template void Tree<double>::start_coupling_response(const LinkLoop<double>&, TreeWork<S>&) const;      \
    EXTERN template S Tree<double>::applied_to_coupling(const LinkLoop<double>&, const S*) const;                 \
    EXTERN template void Tree<double>::solve_rows(TreeWork<S>&, std::vector<S>&) const;                           \
    EXTERN template void Tree<double>::coordinate_rates(const S*, TreeWork<S>&, S*) const;                        \
    EXTERN template void Tree<double>::force_at(const LinkPoint<double>&, const Vector3<S>&, TreeWork<S>&) const;

extern template class Tree<double>;
POLHODE_TREE_INSTANCES(extern, double)
POLHODE_TREE_INSTANCES(extern, Dual<jacobian_directions>)

}  // namespace polhode
