// A scene of one body with formula loads as a system for all methods that accept user-defined systems.
#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "motion/formula_body.h"
#include "motion/formula_mechanism.h"
#include "motion/formula_model_base.h"
#include "motion/problem.h"
#include "motion/user_system.h"

namespace polhode {

/// One body with formula loads as a model (motion/user_system.h).
class FormulaModel : public FormulaModelBase<FormulaBody> {
  public:
    /// From a valid scene of one body. Throws InputError at a fault in a formula.
    explicit FormulaModel(const std::shared_ptr<const Scene>& scene);

    template <class S>
    void derivative(const S* y, S* dy) const {
        form_.derivative(y, dy);
    }
    /// dy/dt with the branches of the current signs.
    template <class S>
    void derivative_by_signs(const S* y, S* dy) const {
        form_.derivative_by(y, dy, true);
    }
    std::vector<Sample> motion(const double* y) const;
    double kinetic_energy(const Bodies& bodies) const;
    const FormulaBody<double>& body() const { return form_; }

  private:
    void scout();
};

/// Replaces the system of a posed problem of one body by the one with the scene's formula loads.
void pose_formula_loads(Problem& problem);

/// The model of a problem of one body with formula loads (has_formula_loads(problem.scene)).
const FormulaModel& formula_model_of(const Problem& problem);

/// Whether the scene, of one or several bodies, has formula loads that switch.
bool has_switches(const Problem& problem);

/// Whether the scene has formula loads with square roots, such as norm(v), of terms that depend on time or state.
bool has_variable_roots(const Problem& problem);

/// The System of a problem with formula loads for methods that use recorded equations or locate switching points. Its
/// projection sets the auxiliary variables to their values.
class FormulaSystem {
  public:
    using Scalar = double;
    static constexpr int dimension = run_time;
    static constexpr bool about_axis = false, has_translation = false;

    explicit FormulaSystem(const Problem& problem) : model_(model_of(problem)), reactions_(problem.reactions) {}

    int size() const {
        return std::visit([](const auto& model) { return model.dimension(); }, model_);
    }
    void initial(double* y) const {
        std::visit([&](const auto& model) { model.initial(y); }, model_);
    }
    bool enter(const Segment& segment, double* y) {
        std::visit([&](auto& model) { model.enter(segment.begin, y); }, model_);
        return true;
    }
    template <class S>
    void derivative(double, const S* y, S* dy) const {
        std::visit([&](const auto& model) { model.derivative(y, dy); }, model_);
    }
    Moment motion(double t, const double* y) const {
        Moment moment{std::visit([&](const auto& model) { return model.motion(y); }, model_), {}};
        for (Sample& body : moment.samples) body.t = t;
        if (reactions_)
            std::visit(
                [&](const auto& model) {
                    if constexpr (requires { model.reactions(y); }) moment.reactions = model.reactions(y);
                },
                model_);
        return moment;
    }
    bool projects() const {
        return has_constraints() || std::visit([](const auto& model) { return model.has_auxiliaries(); }, model_);
    }
    void project(double* y) const {
        project_constraints(y);
        std::visit([&](const auto& model) { model.refresh(y); }, model_);
    }
    /// Whether the equations have square roots of terms that depend on time or state, and their arguments.
    bool has_roots() const {
        return std::visit([](const auto& model) { return model.has_roots(); }, model_);
    }
    std::vector<double> root_arguments(const double* y) const {
        return std::visit([&](const auto& model) { return model.root_arguments(y); }, model_);
    }
    std::vector<SwitchOf<double>> switching_points() const {
        return std::visit([](const auto& model) { return model.switching_points(); }, model_);
    }
    std::string cross_switch(std::size_t which, double* y) {
        return std::visit([&](auto& model) { return model.cross_switch(which, y); }, model_);
    }
    void scales(double* scales) const;

  protected:
    using Model = std::variant<FormulaModel, FormulaMechanismModel>;
    Model model_;

    /// Whether there are loops, and the projection onto their constraints.
    bool has_constraints() const {
        return std::visit(
            [](const auto& model) {
                if constexpr (requires { model.projects(); }) return model.projects();
                return false;
            },
            model_);
    }
    void project_constraints(double* y) const {
        std::visit(
            [&](const auto& model) {
                if constexpr (requires { model.project(y); })
                    if (model.projects()) model.project(y);
            },
            model_);
    }

  private:
    bool reactions_;

    static Model model_of(const Problem& problem) {
        if (problem.needs.system == SystemKind::mechanism_with_formulas) return formula_mechanism_of(problem);
        return formula_model_of(problem);
    }
};

/// The System of a problem with formula loads that switch, for methods that locate the switching points in their steps.
/// The equations remain on the current branches until cross_switch().
class SwitchedSystem : public FormulaSystem {
  public:
    using FormulaSystem::FormulaSystem;

    template <class S>
    void derivative(double, const S* y, S* dy) const {
        std::visit([&](const auto& model) { model.derivative_by_signs(y, dy); }, model_);
    }
    /// Onto the constraints of loops only: numbers do not read the auxiliary variables.
    bool projects() const { return has_constraints(); }
    void project(double* y) const { project_constraints(y); }
    /// By switching point: the distance of its argument from the threshold, negative beyond it. A switch that stays at
    /// its threshold has a negative value when its argument leaves it, which is a fault of cross_switch().
    std::vector<double> switch_values(const double* y) const;
};

inline void jacobian(const SwitchedSystem& system, double t, const double* y, double* J) {
    jacobian_by_columns<jacobian_directions>(system, t, y, J);
}

}  // namespace polhode
