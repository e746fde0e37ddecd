// A scene of several bodies with formula loads as a system for all methods that accept user-defined systems.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "motion/formula_tree.h"
#include "motion/problem.h"
#include "motion/user_system.h"

namespace polhode {

/// Several bodies with formula loads as a model (motion/user_system.h): the equations in binary64, each constant
/// rounded once from 113 bits.
class FormulaMechanismModel {
  public:
    /// From a valid scene of several bodies. Throws InputError at a fault in a formula, and as MechanismModel does.
    explicit FormulaMechanismModel(std::shared_ptr<const Scene> scene);

    const Tree<double>& tree() const { return form_.tree(); }
    int dimension() const { return form_.dimension(); }
    void initial(double* y) const { form_.initial(y); }
    /// dy/dt. Instantiated for the scalars of ErasedModel.
    template <class S>
    void derivative(const S* y, S* dy) const;
    std::vector<double> scales() const { return scales_; }
    std::vector<Sample> motion(const double* y) const;
    void enter(double t, double* y);
    /// Projects y back onto the loop constraints.
    bool projects() const { return tree().has_loops(); }
    void project(double* y) const { tree().project(y); }
    /// Whether there are auxiliary variables. They are read by recorded equations only. refresh() sets them to their
    /// values.
    bool has_auxiliaries() const { return form_.terms().auxiliaries() > 0; }
    void refresh(double* y) const { form_.refresh(y); }
    /// Whether the equations switch at any time of the run.
    bool has_switches() const { return has_switches_; }
    /// Switches on which the equations depend now.
    std::vector<SwitchOf<double>> switching_points() const { return form_.switching_points(); }
    std::string cross_switch(std::size_t which, double* y) {
        return form_.cross_switch(form_.terms().active_switches().at(which), y);
    }
    /// Arguments of the square roots that depend on time or state.
    std::vector<double> root_arguments(const double* y) const {
        return form_.terms().root_arguments(form_.formula_state(y));
    }
    bool has_roots() const { return form_.terms().has_roots(); }
    /// Kinetic energy of all bodies, J.
    double kinetic_energy(const Bodies& bodies) const;
    /// 10^6 times the largest kinetic energy of a coarse run, J.
    double energy_bound() const { return energy_bound_; }
    /// Estimates of the largest |w|, |p| and |v| of any body.
    const Scales& body_scales() const { return body_scales_; }

  private:
    std::shared_ptr<const Scene> scene_;
    std::shared_ptr<const FormulaTree<Wide>> exact_;
    FormulaTree<double> form_;
    std::vector<double> scales_;
    double energy_bound_ = 0;
    bool has_switches_ = false;
    Scales body_scales_;
};

/// @cond internal
extern template void FormulaMechanismModel::derivative(const double*, double*) const;
extern template void FormulaMechanismModel::derivative(const Dual<jacobian_directions>*,
                                                       Dual<jacobian_directions>*) const;
extern template void FormulaMechanismModel::derivative(const Traced<double>*, Traced<double>*) const;
extern template void FormulaMechanismModel::derivative(const Traced<long double>*, Traced<long double>*) const;
/// @endcond

/// Poses a scene of several bodies with formula loads. `problem.system` is a UserSystem.
Problem pose_formula_mechanism(const Scene& scene);

/// The model of a problem of several bodies with formula loads.
const FormulaMechanismModel& formula_mechanism_of(const Problem& problem);

/// The tree of a problem of several bodies, with or without formula loads.
const Tree<double>& tree_of(const Problem& problem);

}  // namespace polhode
