// What the runs of the kind `stability` say, as tables.
#pragma once

#include <string>

#include "experiment/kinds/stability_runs.h"
#include "experiment/plan/experiment.h"
#include "experiment/run/findings.h"

namespace polhode {

/// For each fixed-step method and scene: the largest stable step, the largest within 0.1 and 1e-3 rad, what they cost,
/// and what the next larger step ends in. Steps also in units of the scene's fastest time (step_times_rate).
Table limits_table(const StabilityFindings& found);

/// The same of each family: the least and the largest over its members.
Table families_table(const StabilityFindings& found);

/// For each fixed-step method that has a linear theory, on a linear scene of each direction of the eigenvalue: the
/// largest h |lambda| without growth by theory, and as measured over 50,000 steps (`quick`: 5,000), however small the
/// growth beyond it.
Table measure_linear_limits(const Plan& plan, const StabilityFindings& found, int jobs, bool quick);

/// For each method: how many runs ended in which status and in which outcome.
Table outcomes_table(const Plan& plan, const StabilityFindings& found);

/// For each tolerance-driven method and tolerance: how the runs ended, and the distribution of the largest attitude
/// error over the tolerance.
Table tolerances_table(const Plan& plan, const StabilityFindings& found);

/// For each method that has a binary32 version, and scene: the smallest error of either, the largest step at which
/// arithmetic outweighs the method, and whether binary32 loses the scene for good: never within 0.1 rad where binary64
/// comes within it.
Table float32_table(const StabilityFindings& found);

/// Of float32_table(), for each of its methods: on how many scenes, and which, binary32 is lost for good, and the
/// median over the others of binary32's smallest error over binary64's.
Table lost_table(const Table& float32);

/// For each tolerance-driven method on the stiffest scene of a steady spin whose truth all stiff methods can meet,
/// extreme/drag_torque_1e6: the fewest right-hand sides a second of motion with which it is within 1e-10 rad, and how
/// near the others come. Empty where the scene is not in the plan.
Table damping_table(const Plan& plan, const StabilityFindings& found);

/// Each tolerance-driven run: steps, evaluations, and what the solver tells of its troubles.
Table counts_table(const StabilityFindings& found);

/// Of a method on a family whose members last equally long and differ in stiffness alone.
struct StiffnessCost {
    const Method* method = nullptr;
    std::string family;
    double tolerance = 0;
    std::vector<double> parameter, evaluations;  ///< of the members that ended `ok`, by rising parameter
    std::optional<double> exponent;  ///< p of evaluations ~ parameter^p, least squares over the stiffer half of them
    std::optional<double> lost_at;   ///< the least parameter from which on no run is `ok`
    std::string lost_to;             ///< and how the first of those ended
};
std::vector<StiffnessCost> stiffness_costs(const Plan& plan, const StabilityFindings& found);
/// Flat (exponent near 0) for methods made for it, linear (1) for explicit ones.
Table stiffness_table(const std::vector<StiffnessCost>& costs);
/// Evaluations against the parameter, a panel a family, at the plan's middle tolerance.
std::vector<NamedFigure> stiffness_figures(const Plan& plan, const std::vector<StiffnessCost>& costs);

/// The page: for each method in plain words what it is safe for.
std::string stability_page(const Plan& plan, const StabilityFindings& found, const std::vector<StiffnessCost>& costs,
                           const std::vector<NamedTable>& tables);

}  // namespace polhode
