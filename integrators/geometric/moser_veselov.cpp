// The discrete Moser-Veselov motion with modified moments of inertia.
#include <span>

#include "integrators/geometric/kicked_growth.h"
#include "integrators/geometric/split_flow.h"
#include "integrators/run/binary32.h"

namespace polhode {
namespace {

template <int order, class S = double>
Trajectory solve_moser_veselov(const Problem& problem, const Settings& settings) {
    return march_momentum<Splitting<DiscreteMoserVeselov<order / 2, S>, true, S>>(problem, settings, order);
}

template <int order>
std::string moser_veselov_refusal(const Problem& problem) {
    if (std::string why = kick_refusal(problem); !why.empty() || !composition(order).empty()) return why;
    bool loaded = problem.needs.translation == Translation::integrated && !problem.body.pivoted;
    for (const Segment& segment : problem.segments) loaded = loaded || segment.forcing.any_torque();
    return loaded ? "this order is not available under loads; use moser_veselov8 or a lower order" : "";
}

constexpr std::string_view moser_veselov_source =
    "J. Moser & A. P. Veselov 1991, Commun. Math. Phys. 139, 217; E. Hairer & G. Vilmart 2006, J. Phys. A 39, 13225";
constexpr std::string_view moser_veselov_invariants =
    "|q|; L in world axes exactly and energy to round-off if no torque acts, otherwise L along a uniform force field, "
    "and energy without drift (its error stays of the order of the step's error)";

template <int order>
constexpr Method moser_veselov(std::string_view name, std::string_view documentation) {
    return {.name = name,
            .documentation = documentation,
            .source = moser_veselov_source,
            .conserves = moser_veselov_invariants,
            .control = Control::fixed_step,
            .order = order,
            .solve = solve_moser_veselov<order>,
            // To first order in the angle, the free motion is theta + h theta'. Order 10 does not support loads.
            .pendulum_amplification = order == 10 ? nullptr : &kicked_pendulum_growth<order>,
            .refusal = moser_veselov_refusal<order>};
}

constexpr Method moser_veselov_variants[] = {
    moser_veselov<2>("moser_veselov2",
                     "The discrete Moser-Veselov motion of a free body, which is integrable like the continuous "
                     "motion: three quadratic equations per step, solved to round-off. Loads act as half kicks before "
                     "and after the step. Steps of about one radian or more have no solution. Order 2."),
    moser_veselov<4>(
        "moser_veselov4",
        "moser_veselov2 with moments of inertia modified by the first term of Hairer & Vilmart's series: the same "
        "equations, order 4. Under loads it is a composition of five stages after Suzuki (1990)."),
    moser_veselov<6>(
        "moser_veselov6",
        "moser_veselov2 with moments of inertia modified by two terms of Hairer & Vilmart's series: the same "
        "equations, order 6. Under loads it is a composition of nine stages after Kahan & Li (1997)."),
    moser_veselov<8>(
        "moser_veselov8",
        "moser_veselov2 with moments of inertia modified by three terms of Hairer & Vilmart's series: the same "
        "equations, order 8. Under loads it is a composition of seventeen stages after Kahan & Li (1997)."),
    moser_veselov<10>("moser_veselov10",
                      "moser_veselov2 with moments of inertia modified by four terms of Hairer & Vilmart's series: the "
                      "same equations, order 10. Free bodies only."),
};

constexpr auto moser_veselov_binary64_family =
    apply_defaults({.family = Family::rotation_group}, moser_veselov_variants);

constexpr auto moser_veselov_family =
    with_binary32<moser_veselov_binary64_family, binary32_refusal, solve_moser_veselov<2, float>, nullptr, nullptr,
                  nullptr, nullptr>();

}  // namespace

extern const std::span<const Method> moser_veselov_methods{moser_veselov_family};

}  // namespace polhode
