// Odeint's steppers used by game engines, in binary32: state, coefficients and step are floats.
#include <boost/numeric/odeint/stepper/euler.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta4.hpp>

#include "integrators/odeint/odeint.h"

namespace polhode {
namespace {

namespace odeint = boost::numeric::odeint;

template <std::size_t N>
using FloatArray = OdeintArray<N, float>;
template <std::size_t N>
using FloatEuler = odeint::euler<FloatArray<N>, float, FloatArray<N>, float, OdeintAlgebra<N>>;
template <std::size_t N>
using FloatRk4 = odeint::runge_kutta4<FloatArray<N>, float, FloatArray<N>, float, OdeintAlgebra<N>>;

}  // namespace

Trajectory solve_euler_float32(const Problem& problem, const Settings& settings) {
    return march_odeint<FloatEuler, float>(problem, settings);
}

Trajectory solve_rk4_float32(const Problem& problem, const Settings& settings) {
    return march_odeint<FloatRk4, float>(problem, settings);
}

}  // namespace polhode
