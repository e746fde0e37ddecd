// Mechanisms in joint coordinates by semi-implicit Euler, as in robotics engines.
#include <span>
#include <vector>

#include "integrators/multibody/armature.h"
#include "integrators/multibody/joint_state.h"
#include "integrators/multibody/refusals.h"

namespace polhode {
namespace {

using multibody::JointState;

/// Semi-implicit step: rates first, then coordinates by the new rates, then projection onto the loop constraints.
class SemiImplicitSteps : public JointState {
  public:
    using JointState::JointState;

  protected:
    /// x'' at the current state.
    std::vector<double> accelerations() {
        tree().derivative(y_.data(), dy_.data());
        return {dy_.begin() + static_cast<std::ptrdiff_t>(coordinates()), dy_.end()};
    }
    void advance(double h, const std::vector<double>& a) {
        for (std::size_t k = 0; k < rates(); ++k) y_[coordinates() + k] += h * a[k];
        advance_coordinates(h, y_);
        if (model_->projects()) model_->project(y_.data());
        ++steps_;
    }
};

/// x' += h M^-1 f(x, x'),  x += h x'.
class SemiImplicitEuler : public SemiImplicitSteps {
  public:
    using SemiImplicitSteps::SemiImplicitSteps;
    void step(double, double h) { advance(h, accelerations()); }
};

/// (M + h D) a = f(x, x'),  x' += h a,  x += h x', where D holds the joints' dampers. With M a_0 = f,
/// a = a_0 - (M + h D)^-1 h D a_0.
class ImplicitDamping : public SemiImplicitSteps {
  public:
    explicit ImplicitDamping(const Problem& problem) : SemiImplicitSteps(problem) {
        for (const Link<double>& link : tree().links().links)
            for (int k = 0; k < link.rates(); ++k) {
                damping_.push_back(link.kind == LinkJoint::free ? 0 : link.damping);
                own_armature_.push_back(link.armature);
            }
        for (const double c : damping_) has_damping_ = has_damping_ || c != 0;
    }
    void step(double, double h) {
        std::vector<double> a = accelerations();
        if (has_damping_) {
            TreeWork<double>& at = tree().work<double>();
            tree().move(y_.data(), at);
            armature_.resize(damping_.size()), torque_.resize(damping_.size());
            for (std::size_t k = 0; k < damping_.size(); ++k)
                armature_[k] = h * damping_[k], torque_[k] = armature_[k] * a[k], armature_[k] += own_armature_[k];
            solver_.copy_links(tree(), at);
            solver_.factorize(tree(), armature_);
            solver_.solve(tree(), torque_, change_);
            for (std::size_t k = 0; k < a.size(); ++k) a[k] -= change_[k];
        }
        advance(h, a);
    }

  private:
    std::vector<double> damping_, own_armature_, armature_, torque_, change_;
    bool has_damping_ = false;
    multibody::ArmatureSolver solver_;
};

template <class Update>
Trajectory solve_reduced(const Problem& problem, const Settings& settings) {
    return march<Update>(problem, settings);
}

constexpr Method reduced_variants[] = {
    {.name = "reduced_semi_implicit_euler",
     .documentation =
         "Joint coordinates by the articulated-body recursion and semi-implicit Euler: rates from the accelerations "
         "at the start of the step, then coordinates from the new rates, quaternions by one exponential. Joints "
         "cannot separate. Loops are closed by multipliers on the accelerations and by a projection after each step, "
         "where engines use springs. Order 1.",
     .source = "Google DeepMind, MuJoCo, integrator Euler without implicit damping; E. Coumans, Bullet, btMultiBody",
     .conserves = "joints closed; |q|",
     .solve = solve_reduced<SemiImplicitEuler>},
    {.name = "reduced_implicit_damping",
     .documentation =
         "`reduced_semi_implicit_euler` with implicit joint dampers, (M + h D) a = f: each joint's damper adds h c to "
         "the diagonal of M, like an armature in the recursion. Dampers that are fast compared with the step remain "
         "stable; springs do not. Order 1.",
     .source = "Google DeepMind, MuJoCo, integrator Euler (eulerdamp) and, for joint damping, implicitfast",
     .conserves = "joints closed; |q|",
     .solve = solve_reduced<ImplicitDamping>},
};

constexpr auto reduced_family = apply_defaults({.control = Control::fixed_step,
                                                .general_systems = true,
                                                .order = 1,
                                                .family = Family::engine_update,
                                                .refusal = multibody::mechanism_refusal},
                                               reduced_variants);

}  // namespace

extern const std::span<const Method> reduced_coordinates_methods{reduced_family};

}  // namespace polhode
