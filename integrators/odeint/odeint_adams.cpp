#include <boost/numeric/odeint/stepper/adams_bashforth_moulton.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>
#include <cmath>

#include "integrators/odeint/odeint.h"
#include "integrators/run/amplification.h"

namespace polhode {
namespace {

namespace odeint = boost::numeric::odeint;

/// Start-up method in place of Odeint's runge_kutta4: the total error of its five steps is O(h^9).
template <std::size_t N>
using StartUp = odeint::runge_kutta_fehlberg78<OdeintArray<N>, double, OdeintArray<N>, double, OdeintAlgebra<N>>;
template <std::size_t N>
using Adams6 = odeint::adams_bashforth_moulton<6, OdeintArray<N>, double, OdeintArray<N>, double, OdeintAlgebra<N>,
                                               odeint::default_operations, odeint::initially_resizer, StartUp<N>>;

/// The formulas require equal steps. A different step size restarts the history.
template <class SystemType>
class AdamsStepper : public OdeintFixedStepper<SystemType, Adams6> {
    using Base = OdeintFixedStepper<SystemType, Adams6>;

  public:
    using Base::Base;
    void step(double t, double h) {
        // Steps between two samples differ only by rounding.
        if (!(std::abs(h - spacing_) <= 1e-9 * h)) {
            this->clear_history();
            spacing_ = h;
        }
        Base::step(t, h);
    }

  private:
    double spacing_ = 0;
};

}  // namespace

// p = y_n + z sum b_j y_(n-j), y_(n+1) = y_n + z (b*_0 p + sum b*_(j+1) y_(n-j)). The last evaluation uses the
// corrected value, at the start of the next step.
double adams_bashforth_moulton_growth(std::complex<double> z) {
    constexpr std::size_t steps = 6;
    const odeint::detail::adams_bashforth_coefficients<double, steps> predictor;
    const odeint::detail::adams_moulton_coefficients<double, steps> corrector;
    std::array<std::complex<double>, steps> c{};
    for (std::size_t j = 0; j < steps; ++j) {
        c[j] = z * corrector[0] * z * predictor[j];
        if (j + 1 < steps) c[j] += z * corrector[j + 1];
    }
    c[0] += 1.0 + z * corrector[0];
    return largest_root(c);
}

Trajectory solve_adams_bashforth_moulton(const Problem& problem, const Settings& settings) {
    return with_system(problem, [&]<class SystemType>() { return march<AdamsStepper<SystemType>>(problem, settings); });
}

}  // namespace polhode
