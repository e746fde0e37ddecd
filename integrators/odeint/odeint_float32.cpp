// Odeint's steppers used by game engines, in binary32: state, coefficients and step are floats.
#include <boost/numeric/odeint/stepper/euler.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta4.hpp>

#include "integrators/odeint/odeint.h"

namespace polhode {
namespace {

namespace odeint = boost::numeric::odeint;

template <std::size_t N>
using State = OdeintArray<N, float>;
template <std::size_t N>
using Euler = odeint::euler<State<N>, float, State<N>, float, OdeintAlgebra<N>>;
template <std::size_t N>
using Rk4 = odeint::runge_kutta4<State<N>, float, State<N>, float, OdeintAlgebra<N>>;

}  // namespace

Trajectory solve_euler_float32(const Problem& problem, const Settings& settings) {
    return march_odeint<Euler, float>(problem, settings);
}

Trajectory solve_rk4_float32(const Problem& problem, const Settings& settings) {
    return march_odeint<Rk4, float>(problem, settings);
}

}  // namespace polhode
