// Limits and friction of joints in joint coordinates: rows of one rate each, and the response of all rates to their
// forces.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "integrators/multibody/armature.h"
#include "integrators/multibody/joint_limits.h"

namespace polhode::multibody {

/// A limit that is passed, or the friction of a joint: a generalized force along `sign` times a rate.
struct ReducedRow {
    std::size_t rate = 0;        ///< index of the rate
    std::size_t constraint = 0;  ///< index among all constraints: of each joint, its limits, then its friction
    double sign = 1;             ///< limits: 1 or -1, away from the limit
    double gap = 0;              ///< limits: negative; m or rad
    double friction = 0;         ///< friction: the largest force, N or N m; 0 for limits
    double velocity = 0;         ///< sign times the rate
    double inverse_inertia = 0;  ///< the rate's diagonal entry of M^-1 with all coordinates zero
};

class ReducedRows {
  public:
    ReducedRows(const Scene& scene, const Tree<double>& tree);

    /// The number of joints with limits plus the number of joints with friction.
    std::size_t constraints() const { return constraints_; }
    /// Selects the rows that act at the state y, joint by joint: limits that are passed, then friction.
    const std::vector<ReducedRow>& select(const Tree<double>& tree, const double* y);
    /// Computes J M^-1 J^T of the selected rows at the state y, row by row.
    std::vector<double> inverse_inertia(const Tree<double>& tree, const double* y);
    /// rates += M^-1 J^T forces. Requires inverse_inertia() at this state.
    void apply(const std::vector<double>& forces, double* rates) const;

  private:
    struct JointLaws {
        std::size_t coordinate, rate;  // indices in y, and among the rates
        std::size_t constraint;        // index of its limits, or without limits of its friction
        bool has_limits;
        double friction;
        std::array<JointLimit<double>, 2> limits;
        double inverse_inertia = 0;
    };
    std::vector<JointLaws> joints_;
    std::size_t constraints_ = 0;
    std::vector<ReducedRow> rows_;
    std::vector<std::vector<double>> responses_;  // M^-1 J^T, by row
    std::vector<double> armature_;
    ArmatureSolver solver_;

    void factorize(const Tree<double>& tree, const double* y);
    std::vector<double> respond(const Tree<double>& tree, std::size_t rate, double force);
};

}  // namespace polhode::multibody
