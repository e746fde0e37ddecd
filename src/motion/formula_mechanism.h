// A scene of several bodies with formula loads as a system for all methods that accept user-defined systems.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "motion/formula_model_base.h"
#include "motion/formula_tree.h"
#include "motion/problem.h"
#include "motion/user_system.h"

namespace polhode {

/// Several bodies with formula loads as a model (motion/user_system.h).
class FormulaMechanismModel : public FormulaModelBase<FormulaTree> {
  public:
    /// From a valid scene of several bodies. Throws InputError at a fault in a formula, and as MechanismModel does.
    explicit FormulaMechanismModel(const std::shared_ptr<const Scene>& scene);

    const Tree<double>& tree() const { return form_.tree(); }
    /// dy/dt. Instantiated for the scalars of ErasedModel.
    template <class S>
    void derivative(const S* y, S* dy) const;
    /// dy/dt with the branches of the current signs. Instantiated for double and dual numbers.
    template <class S>
    void derivative_by_signs(const S* y, S* dy) const;
    std::vector<Sample> motion(const double* y) const;
    std::vector<Reaction<double>> reactions(const double* y) const { return form_.reactions(*scene_, y, false); }
    /// Projects y back onto the loop constraints.
    bool projects() const { return tree().has_loops(); }
    void project(double* y) const { tree().project(y); }
    /// Kinetic energy of all bodies, J.
    double kinetic_energy(const Bodies& bodies) const;
};

/// @cond internal
extern template void FormulaMechanismModel::derivative(const double*, double*) const;
extern template void FormulaMechanismModel::derivative(const Dual<jacobian_directions>*,
                                                       Dual<jacobian_directions>*) const;
extern template void FormulaMechanismModel::derivative(const Traced<double>*, Traced<double>*) const;
extern template void FormulaMechanismModel::derivative_by_signs(const double*, double*) const;
extern template void FormulaMechanismModel::derivative_by_signs(const Dual<jacobian_directions>*,
                                                                Dual<jacobian_directions>*) const;
extern template void FormulaMechanismModel::derivative(const Traced<long double>*, Traced<long double>*) const;
/// @endcond

/// Poses a scene of several bodies with formula loads. `problem.system` is a UserSystem.
Problem pose_formula_mechanism(const Scene& scene);

/// The model of a problem of several bodies with formula loads.
const FormulaMechanismModel& formula_mechanism_of(const Problem& problem);

/// The tree of a problem of several bodies, with or without formula loads.
const Tree<double>& tree_of(const Problem& problem);
/// The scales of its coordinates and rates, and of further variables of formulas.
std::vector<double> tree_scales(const Problem& problem);

}  // namespace polhode
