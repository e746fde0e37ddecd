#include "integrators/multibody/sequential_impulses.h"

#include <span>

#include "integrators/multibody/in_binary32.h"

namespace polhode {
namespace {

using multibody::ImpulseOptions;

template <class S, ImpulseOptions options>
Trajectory solve_by_impulses(const Problem& problem, const Settings& settings) {
    return march<multibody::SequentialImpulses<S, options>>(problem, settings);
}

constexpr ImpulseOptions four{.iterations = 4}, ten{.iterations = 10}, fifty{.iterations = 50},
    split{.iterations = 10, .split = true}, cold{.iterations = 10, .warm_start = false},
    plain{.iterations = 10, .gyroscopic_term = false}, blocks{.iterations = 10, .blocks = true};

constexpr Method each_by_impulses[] = {
    {.name = "sequential_impulses_10",
     .documentation =
         "Sequential impulses as game engines solve joints: each body with all six freedoms, semi-implicit Euler, and "
         "for each scalar row of each joint in turn the impulse that makes it hold, 10 times round (projected Gauss "
         "and Seidel), beginning with the impulses of the step before (warm starting). What the positions are off by "
         "is asked back at beta/h, beta = 0.2 (Baumgarte). The gyroscopic term in one Newton step. Joints' springs, "
         "dampers and motors are forces at the step's begin. An impulse hits its body alone, and the next step takes "
         "it to the others. What the iterations leave lives on in the velocities, and goes as the step does: order 1 "
         "wherever the iteration is stable. Warm starting and Baumgarte's term together need not be: where n rounds "
         "leave more than some 0.83 of an error in the impulses (a weld, a slender link, many links) each step "
         "multiplies it by up to 1.05, and the motion blows up, the sooner the shorter the step. Split impulses or a "
         "cold start do not. Bullet and ODE begin joints at zero (see `sequential_impulses_cold_10`), Box2D solves "
         "joints by blocks.",
     .solve = solve_by_impulses<double, ten>},
    {.name = "sequential_impulses_4",
     .documentation = "`sequential_impulses_10` with 4 iterations a step.",
     .solve = solve_by_impulses<double, four>},
    {.name = "sequential_impulses_50",
     .documentation = "`sequential_impulses_10` with 50 iterations a step.",
     .solve = solve_by_impulses<double, fifty>},
    {.name = "sequential_impulses_split_10",
     .documentation =
         "`sequential_impulses_10` with split impulses: positions are mended by velocities of their own, found by an "
         "iteration of their own and forgotten after the step, so that the motion keeps no energy of the mending.",
     .solve = solve_by_impulses<double, split>},
    {.name = "sequential_impulses_cold_10",
     .documentation = "`sequential_impulses_10` without warm starting: each step finds all impulses from zero.",
     .solve = solve_by_impulses<double, cold>},
    {.name = "sequential_impulses_block_10",
     .documentation =
         "`sequential_impulses_10` with the rows of a joint's axes solved together, then those of its points: what "
         "Box2D to v2.4 does, where warm starting is on and stays stable more often than row by row.",
     .source = "E. Catto, Box2D v2.4, b2RevoluteJoint, b2WeldJoint",
     .solve = solve_by_impulses<double, blocks>},
    {.name = "sequential_impulses_no_gyroscopic_10",
     .documentation =
         "`sequential_impulses_10` without the gyroscopic term w x I w, as engines have it whose bodies keep w in the "
         "world's axes: right in the plane, and another motion than the body's in space, whatever the step.",
     .conserves = "|q|",
     .solve = solve_by_impulses<double, plain>},
};

constexpr auto by_impulses =
    sharing({.source = "E. Catto 2005, Iterative Dynamics with Temporal Coherence, Game Developers Conference; split "
                       "impulses: E. Coumans, Bullet, btSequentialImpulseConstraintSolver",
             .conserves = "|q|; linear momentum of a mechanism that nothing ties to the world",
             .control = Control::fixed_step,
             .own_systems = true,
             .order = 1,
             .family = Family::engine_update,
             .refuses = multibody::needs_inertia_of_each_body},
            each_by_impulses);

constexpr auto all_by_impulses =
    multibody::with_binary32_twins<by_impulses, solve_by_impulses<float, ten>, solve_by_impulses<float, four>,
                                   solve_by_impulses<float, fifty>, solve_by_impulses<float, split>,
                                   solve_by_impulses<float, cold>, solve_by_impulses<float, blocks>, nullptr>();

}  // namespace

extern const std::span<const Method> sequential_impulses_methods{all_by_impulses};

}  // namespace polhode
