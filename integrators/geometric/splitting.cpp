// Splitting methods: the free motion, by rotations about the principal axes or exactly, and kicks by the loads.
#include <span>

#include "integrators/geometric/kicked_growth.h"
#include "integrators/geometric/split_flow.h"
#include "integrators/run/binary32.h"

namespace polhode {
namespace {

template <class Flow, bool single_stage_when_free, int order, class S = double>
Trajectory solve_splitting(const Problem& problem, const Settings& settings) {
    return march_momentum<Splitting<Flow, single_stage_when_free, S>>(problem, settings, order);
}

constexpr std::string_view rotations_source =
    "S. Reich 1994, Physica D 76, 375; R. I. McLachlan 1993, Phys. Rev. Lett. 71, 3043; A. Dullweber, B. Leimkuhler & "
    "R. McLachlan 1997, J. Chem. Phys. 107, 5840";
constexpr std::string_view exact_flow_source =
    "R. I. McLachlan & A. Zanna 2005, Found. Comput. Math. 5, 87; E. Celledoni, F. Fasso, N. Safstrom & A. Zanna 2008, "
    "SIAM J. Sci. Comput. 30, 2084; free motion by series, and by C. G. J. Jacobi 1849 where they are long";
constexpr std::string_view rotations_invariants =
    "|q|; L in world axes exactly if no torque acts, otherwise its component along a uniform force field; if there is "
    "an energy, it does not drift (its error stays of the order of the step's error)";
constexpr std::string_view exact_flow_invariants =
    "|q|; L in world axes exactly and energy to round-off if no torque acts, otherwise L along a uniform force field, "
    "and energy without drift (its error stays of the order of the step's error)";

template <int order>
constexpr Method rotations(std::string_view name, std::string_view documentation) {
    return {.name = name,
            .documentation = documentation,
            .source = rotations_source,
            .conserves = rotations_invariants,
            .control = Control::fixed_step,
            .order = order,
            .solve = solve_splitting<ThreeRotations<>, false, order>,
            .pendulum_amplification = kicked_pendulum_growth<order>};
}
template <int order>
constexpr Method exact_flow(std::string_view name, std::string_view documentation) {
    return {.name = name,
            .documentation = documentation,
            .source = exact_flow_source,
            .conserves = exact_flow_invariants,
            .control = Control::fixed_step,
            .order = order,
            .solve = solve_splitting<ExactFreeMotion, true, order>,
            .pendulum_amplification = kicked_pendulum_growth<order>};
}

constexpr Method splitting_variants[] = {
    rotations<2>("splitting2",
                 "The kinetic energy split into its three terms: rotations about the principal axes in the order 1 2 3 "
                 "2 1, between two half kicks by the loads. Explicit and time-reversible, and symplectic if the loads "
                 "have a potential. Drag is solved exactly within a kick. User-defined torques are refused. Order 2."),
    rotations<4>("splitting4",
                 "splitting2 composed of five stages after Suzuki (1990). One stage has a negative step, in which "
                 "strong drag grows. Order 4."),
    rotations<6>("splitting6",
                 "splitting2 composed of nine stages after Kahan & Li (1997). Some stages have negative steps, in "
                 "which strong drag grows. Order 6."),
    rotations<8>("splitting8",
                 "splitting2 composed of seventeen stages after Kahan & Li (1997). Some stages have negative steps, in "
                 "which strong drag grows. Order 8."),
    exact_flow<2>("splitting_exact2",
                  "The exact free motion between two half kicks by the loads. Without torque the only error is "
                  "round-off. Best suited to fast rotation under slow loads. Explicit and time-reversible, and "
                  "symplectic if the loads have a potential. User-defined torques are refused. Order 2."),
    exact_flow<4>("splitting_exact4",
                  "splitting_exact2 composed of five stages after Suzuki (1990). One stage has a negative step, in "
                  "which strong drag grows. Order 4."),
    exact_flow<6>("splitting_exact6",
                  "splitting_exact2 composed of nine stages after Kahan & Li (1997). Some stages have negative steps, "
                  "in which strong drag grows. Order 6."),
    exact_flow<8>("splitting_exact8",
                  "splitting_exact2 composed of seventeen stages after Kahan & Li (1997). Some stages have negative "
                  "steps, in which strong drag grows. Order 8."),
};

constexpr auto splitting_binary64_family =
    apply_defaults({.family = Family::splitting, .refusal = kick_refusal}, splitting_variants);

constexpr auto splitting_family =
    with_binary32<splitting_binary64_family, binary32_refusal, solve_splitting<ThreeRotations<float>, false, 2, float>,
                  solve_splitting<ThreeRotations<float>, false, 4, float>, nullptr, nullptr, nullptr, nullptr, nullptr,
                  nullptr>();

}  // namespace

extern const std::span<const Method> splitting_methods{splitting_family};

}  // namespace polhode
