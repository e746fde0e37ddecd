#include <boost/numeric/odeint/stepper/adams_bashforth_moulton.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>
#include <cmath>

#include "integrators/odeint.h"

namespace polhode {
namespace {

namespace odeint = boost::numeric::odeint;

/// The start-up, in the place of Odeint's runge_kutta4: five steps of it err by O(h^9) together.
template <std::size_t N>
using StartUp = odeint::runge_kutta_fehlberg78<OdeintArray<N>, double, OdeintArray<N>, double, OdeintAlgebra>;
template <std::size_t N>
using Adams6 = odeint::adams_bashforth_moulton<6, OdeintArray<N>, double, OdeintArray<N>, double, OdeintAlgebra,
                                               odeint::default_operations, odeint::initially_resizer, StartUp<N>>;

/// The formulas hold for steps of one length: another one starts the history again.
template <class SystemType>
class AdamsStepper : public OdeintFixedStepper<SystemType, Adams6> {
    using Base = OdeintFixedStepper<SystemType, Adams6>;

  public:
    using Base::Base;
    void step(double t, double h) {
        // whole steps between two samples differ by rounding only
        if (!(std::abs(h - spacing_) <= 1e-9 * h)) {
            this->forget();
            spacing_ = h;
        }
        Base::step(t, h);
    }

  private:
    double spacing_ = 0;
};

}  // namespace

Trajectory solve_adams_bashforth_moulton(const Problem& problem, const Settings& settings) {
    return with_system(problem, [&]<class SystemType>() { return march<AdamsStepper<SystemType>>(problem, settings); });
}

}  // namespace polhode
