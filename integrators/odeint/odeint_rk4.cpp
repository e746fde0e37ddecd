#include <boost/numeric/odeint/stepper/runge_kutta4.hpp>

#include "integrators/odeint/odeint.h"

namespace polhode {
namespace {

template <std::size_t N>
using ClassicalRk4 =
    boost::numeric::odeint::runge_kutta4<OdeintArray<N>, double, OdeintArray<N>, double, OdeintAlgebra<N>>;

}  // namespace

Trajectory solve_rk4(const Problem& problem, const Settings& settings) {
    return march_odeint<ClassicalRk4>(problem, settings);
}

}  // namespace polhode
