// Loads given by formulas, evaluated by the driver from the engine's state at the start of each step.
//
// FormulaLoads evaluates the operations of an EngineFormulas in binary64 and sums the loads of each body as a force at
// its centre of mass and a torque, in world axes. A motor is a pair of opposite loads on the two bodies of its joint.
// The caller applies them for the step. node/formulas.js is the same for engines under Node.
#pragma once

#include <vector>

#include "integrators/engines/drivers/mechanism.h"
#include "integrators/engines/engine_formulas.h"

namespace polhode::engines {

/// Force at the centre of mass and torque, world axes.
struct BodyLoad {
    Vector3<double> force, torque;
};

class FormulaLoads {
  public:
    /// For one body, `mechanism` has no joints. The arguments must outlive this object.
    FormulaLoads(const EngineFormulas& formulas, const Mechanism& mechanism);

    /// The ends of the parts of a step from t to `stop`, s: the times at which a load begins, ends or is sampled, and
    /// `stop`. Steps are given in increasing order.
    std::vector<double> split(double t, double stop);
    /// The loads on all bodies for a step from t to t + h, s. `motions`: of all bodies at t. Values of a period are
    /// sampled in the first step that starts at a multiple of it or later. A load acts in the steps whose middle is in
    /// its window. Throws std::runtime_error if a load that acts has no finite value.
    const std::vector<BodyLoad>& evaluate(double t, double h, const std::vector<Motion>& motions);

  private:
    const EngineFormulas* formulas_;
    const Mechanism* mechanism_;
    std::vector<double> inputs_, values_;
    std::size_t next_time_ = 0;             ///< of formulas_->times
    std::vector<double> due_;               ///< by held value: the multiple at which it is sampled next
    std::vector<std::size_t> joints_read_;  ///< joints whose coordinates formulas read
    std::vector<BodyLoad> loads_;

    void set_inputs(double t, const std::vector<Motion>& motions);
    void sample(double t, double h);
    void compute(std::size_t count);
    double compute_operation(const formula::Node& node) const;
    void add_load(const EngineFormulaLoad& load, double t, const std::vector<Motion>& motions);
};

}  // namespace polhode::engines
