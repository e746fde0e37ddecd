// (M + diag(d)) x = tau by the articulated-body recursion, M the mass matrix of a tree in its rates: what moves by a
// joint gets an inertia d of its own beside the bodies', a motor's armature. With d = h c that is the matrix of an
// implicit damper c; with d = 0 it is M alone.
#pragma once

#include <cstddef>
#include <vector>

#include "motion/tree.h"

namespace polhode::multibody {

/// A recursion of its own beside the tree's: that one knows that a joint without armature gives way entirely.
class ArmatureSolver {
  public:
    /// `at`: what tree.move() has made of a state; taken over link by link.
    void take(const Tree<double>& tree, const TreeWork<double>& at);
    /// `armature`: d of each rate (a free base's are not looked at), then solve() may be called.
    void factorize(const Tree<double>& tree, const std::vector<double>& armature);
    /// tau in, x out; both in the order of the rates.
    void solve(const Tree<double>& tree, const std::vector<double>& torque, std::vector<double>& x);

  private:
    std::vector<LinkWork<double>> links_;
};

}  // namespace polhode::multibody
