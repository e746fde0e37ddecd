#include "integrators/multibody/sequential_impulses.h"

#include <span>

#include "integrators/multibody/binary32_variants.h"

namespace polhode {
namespace {

using multibody::ImpulseOptions;

template <class S, ImpulseOptions options>
Trajectory solve_sequential_impulses(const Problem& problem, const Settings& settings) {
    return march<multibody::SequentialImpulses<S, options>>(problem, settings);
}

constexpr ImpulseOptions iterations_4{.iterations = 4}, iterations_10{.iterations = 10},
    iterations_50{.iterations = 50}, split_impulses{.iterations = 10, .split = true},
    cold_start{.iterations = 10, .warm_start = false}, no_gyroscopic_term{.iterations = 10, .gyroscopic_term = false},
    block_solver{.iterations = 10, .blocks = true};

constexpr Method sequential_impulses_variants[] = {
    {.name = "sequential_impulses_10",
     .documentation =
         "Sequential impulses as in the joint solvers of game engines: each body with six degrees of freedom, "
         "semi-implicit Euler, and 10 iterations of projected Gauss-Seidel over the scalar rows of all joints, "
         "starting from the impulses of the previous step (warm starting). Position errors are corrected at the rate "
         "beta/h, beta = 0.2 (Baumgarte). The gyroscopic term takes one Newton step. Springs, dampers and motors of "
         "joints are forces at the start of the step. Friction F of a joint is an impulse of at most F h against its "
         "rate. Limits without restitution stop the joint at the end of the step in which it arrives; with restitution "
         "it bounces in the next step. An external impulse acts only on its body; the next step "
         "propagates it to the others. The residual of the iteration remains in the velocities and decreases with the "
         "step: order 1 wherever the iteration is stable. Warm starting combined with Baumgarte's term can be "
         "unstable: if the iterations leave more than about 0.83 of an error in the impulses (a weld, a slender link, "
         "many links), each step multiplies it by up to 1.05, and the motion blows up, the sooner the shorter the "
         "step. Split impulses or a cold start avoid this. Bullet and ODE start joints from zero (see "
         "`sequential_impulses_cold_10`), Box2D solves joints by blocks.",
     .solve = solve_sequential_impulses<double, iterations_10>},
    {.name = "sequential_impulses_4",
     .documentation = "`sequential_impulses_10` with 4 iterations per step.",
     .solve = solve_sequential_impulses<double, iterations_4>},
    {.name = "sequential_impulses_50",
     .documentation = "`sequential_impulses_10` with 50 iterations per step.",
     .solve = solve_sequential_impulses<double, iterations_50>},
    {.name = "sequential_impulses_split_10",
     .documentation =
         "`sequential_impulses_10` with split impulses: positions are corrected by separate velocities, which a "
         "separate iteration computes and which are discarded after the step, so that the correction adds no energy "
         "to the motion.",
     .solve = solve_sequential_impulses<double, split_impulses>},
    {.name = "sequential_impulses_cold_10",
     .documentation = "`sequential_impulses_10` without warm starting: the iteration of each step starts from zero.",
     .solve = solve_sequential_impulses<double, cold_start>},
    {.name = "sequential_impulses_block_10",
     .documentation =
         "`sequential_impulses_10` with the rows of a joint's axes solved together, then those of its points, as in "
         "Box2D up to v2.4. Warm starting is on and is stable in more cases than row by row.",
     .source = "E. Catto, Box2D v2.4, b2RevoluteJoint, b2WeldJoint",
     .solve = solve_sequential_impulses<double, block_solver>},
    {.name = "sequential_impulses_no_gyroscopic_10",
     .documentation =
         "`sequential_impulses_10` without the gyroscopic term w x I w, as in engines whose bodies store w in world "
         "axes. Correct in the plane. In space it converges to a different motion, whatever the step.",
     .conserves = "|q|",
     .solve = solve_sequential_impulses<double, no_gyroscopic_term>},
};

constexpr auto sequential_impulses_binary64_family = apply_defaults(
    {.source = "E. Catto 2005, Iterative Dynamics with Temporal Coherence, Game Developers Conference; split "
               "impulses: E. Coumans, Bullet, btSequentialImpulseConstraintSolver",
     .conserves = "|q|; linear momentum of a mechanism that is not connected to the world",
     .control = Control::fixed_step,
     .general_systems = true,
     .order = 1,
     .family = Family::engine_update,
     .refusal = multibody::impulse_refusal},
    sequential_impulses_variants);

constexpr auto sequential_impulses_family = multibody::with_binary32_variants<
    sequential_impulses_binary64_family, solve_sequential_impulses<float, iterations_10>,
    solve_sequential_impulses<float, iterations_4>, solve_sequential_impulses<float, iterations_50>,
    solve_sequential_impulses<float, split_impulses>, solve_sequential_impulses<float, cold_start>,
    solve_sequential_impulses<float, block_solver>, nullptr>();

}  // namespace

extern const std::span<const Method> sequential_impulses_methods{sequential_impulses_family};

}  // namespace polhode
