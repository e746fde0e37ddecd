// Mechanisms in joint coordinates by semi-implicit Euler, as in robotics engines.
#include <span>

#include "integrators/multibody/reduced_steps.h"
#include "integrators/multibody/refusals.h"

namespace polhode {
namespace {

using multibody::ImplicitDamping, multibody::SemiImplicitSteps;

/// x' += h M^-1 f(x, x'),  x += h x'.
class SemiImplicitEuler : public SemiImplicitSteps {
  public:
    using SemiImplicitSteps::SemiImplicitSteps;
    void step(double, double h) { advance(h, accelerations()); }
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
