// The common part of the models with formula loads of one body (formula_model.h) and of several (formula_mechanism.h).
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "body/wide.h"
#include "motion/formula_terms.h"
#include "motion/problem.h"

namespace polhode {

/// `FormOf<P>`: the equations over the scalar P, FormulaBody or FormulaTree. Each constant is rounded once from 113
/// bits.
template <template <class> class FormOf>
class FormulaModelBase {
  public:
    int dimension() const { return form_.dimension(); }
    void initial(double* y) const { form_.initial(y); }
    std::vector<double> scales() const { return scales_; }
    void enter(double t, double* y) {
        FormOf<Wide> exact = *exact_;
        exact.enter_loads(*scene_, t);
        form_ = FormOf<double>(exact);
        form_.apply_event(*scene_, t, y);
    }
    /// Applies the impulses at t to the state of another motion, and sets its time and auxiliaries. The loads are those
    /// of enter().
    void enter_other(double t, double* y) { form_.apply_event(*scene_, t, y); }
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
    /// Whether the equations have square roots whose arguments depend on time or state.
    bool has_roots() const { return form_.terms().has_roots(); }
    /// The arguments of these square roots.
    std::vector<double> root_arguments(const double* y) const {
        return form_.terms().root_arguments(form_.formula_state(y));
    }
    /// 10^6 times the largest kinetic energy of a coarse run, J.
    double energy_bound() const { return energy_bound_; }
    /// Estimates of the largest |w|, |p| and |v| of any body.
    const Scales& body_scales() const { return body_scales_; }

  protected:
    FormulaModelBase(std::shared_ptr<const Scene> scene, FormOf<Wide> exact)
        : scene_(std::move(scene)), exact_(std::make_shared<const FormOf<Wide>>(std::move(exact))), form_(*exact_) {}

    std::shared_ptr<const Scene> scene_;
    std::shared_ptr<const FormOf<Wide>> exact_;
    FormOf<double> form_;
    std::vector<double> scales_;
    double energy_bound_ = 0;
    bool has_switches_ = false;
    Scales body_scales_;
};

}  // namespace polhode
