// Solves (M + diag(d)) x = tau by the articulated-body recursion. M is the mass matrix of a tree in its rates, and d an
// additional inertia of each joint (armature of a motor). With d = h c this is the matrix of an implicit damper c; with
// d = 0 it is M.
#pragma once

#include <cstddef>
#include <vector>

#include "motion/tree.h"

namespace polhode::multibody {

/// Has its own recursion: the tree's recursion assumes joints without armature.
class ArmatureSolver {
  public:
    /// Copies the links' data from `at`, which tree.move() has computed for a state.
    void copy_links(const Tree<double>& tree, const TreeWork<double>& at);
    /// `armature`: d of each rate (those of a free base are ignored). Must be called before solve().
    void factorize(const Tree<double>& tree, const std::vector<double>& armature);
    /// Solves for x given tau. Both are in the order of the rates.
    void solve(const Tree<double>& tree, const std::vector<double>& torque, std::vector<double>& x);

  private:
    std::vector<LinkWork<double>> links_;

    void sweep_inward(const Links<double>& all, const std::vector<double>& torque);
    void sweep_outward(const Links<double>& all, const std::vector<double>& torque, std::vector<double>& x);
};

}  // namespace polhode::multibody
