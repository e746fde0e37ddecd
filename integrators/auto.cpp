// Which method `auto` stands for.
#include "integrators/auto.h"

#include <algorithm>
#include <cmath>

#include "integrators/exact.h"
#include "integrators/method.h"

namespace polhode {
namespace {

// beyond this many decay times an explicit step is bound by stability, not by accuracy
constexpr double stiff_decays = 1e4;

// A bound on the spectral radius of I^-1 D: its largest row sum; likewise the drag on translation, where integrated.
double damping_rate(const Problem& problem, const Forcing<double>& forcing) {
    double rate = 0;
    if (forcing.has_damping) {
        Matrix3<double> decay;
        if (problem.formulation == Formulation::full) {
            decay = problem.full_inertia.inverse * forcing.damping;
        } else {
            decay = diagonal(problem.principal_inertia.inverse_moments) * forcing.damping;
        }
        for (const Vector3<double>& row : decay.row)
            rate = std::max(rate, std::abs(row[0]) + std::abs(row[1]) + std::abs(row[2]));
    }
    if (forcing.has_translational_drag && problem.needs.dimension == 13 && !problem.body.pivoted)
        rate = std::max(rate, std::abs(forcing.specific_drag));
    return rate;
}

}  // namespace

bool is_stiff(const Problem& problem) {
    double decays = 0;
    for (const Segment& segment : problem.segments)
        decays += damping_rate(problem, segment.forcing) * (segment.end - segment.begin);
    return decays > stiff_decays && !problem.needs.user_torque;
}

Choice choose_method(const Problem& problem) {
    if (!problem.scene.planes.empty()) return {find_method("cvode_impacts"), "impacts on planes, located as events"};
    if (const Method* method = find_method("exact"); method && has_closed_form(problem))
        return {method, "the motion has a closed form"};
    if (is_stiff(problem))
        if (const Method* method = find_method("cvode_bdf"))
            return {method, "the motion is stiff: damping decays more than 10^4 times within the duration"};
    if (!problem.needs.user_torque)
        return {find_method("taylor"), "smooth motion without stiffness: a Taylor series comes nearest to round-off"};
    return {find_method("odeint_fehlberg78"),
            "a torque of the user's own has no Taylor coefficients: a Runge-Kutta "
            "pair of high order comes nearest to round-off"};
}

}  // namespace polhode
