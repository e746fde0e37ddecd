// State and algebra for Boost.Odeint's steppers: arrays of fixed size, whose loops the compiler unrolls (RK4 step of
// a free body: 43 ns; 90 ns with manually unrolled loops), and a norm that is infinite for NaN, so that a step with
// NaN is never accepted.
#pragma once

#include <array>
#include <boost/numeric/odeint/algebra/array_algebra.hpp>
#include <boost/numeric/odeint/algebra/range_algebra.hpp>
#include <boost/numeric/odeint/util/is_resizeable.hpp>
#include <cmath>
#include <cstddef>
#include <limits>
#include <type_traits>
#include <vector>

#include "motion/user_system.h"

namespace polhode {

/// N numbers, initialised to zero, because Odeint's steppers copy their scratch space before writing to it.
template <std::size_t N, class S = double>
struct OdeintArray : std::array<S, N> {
    static constexpr std::size_t dimension = N;

    OdeintArray() : std::array<S, N>{} {}
    explicit OdeintArray(int) : OdeintArray() {}
};

/// N for sizes known only at run time. Odeint resizes its scratch space to the size of the state.
inline constexpr std::size_t odeint_run_time = static_cast<std::size_t>(run_time);
template <class S>
struct OdeintArray<odeint_run_time, S> : std::vector<S> {
    OdeintArray() = default;
    explicit OdeintArray(int n) : std::vector<S>(static_cast<std::size_t>(n)) {}
};

/// Odeint's loops over fixed-size arrays or ranges, with the NaN-safe norm.
template <std::size_t N>
struct OdeintAlgebra : std::conditional_t<N == odeint_run_time, boost::numeric::odeint::range_algebra,
                                          boost::numeric::odeint::array_algebra> {
    /// The largest magnitude; infinity if a component is NaN.
    static double norm_inf(const OdeintArray<N>& s) {
        double norm = 0;
        for (double value : s) {
            const double magnitude = std::abs(value);
            if (magnitude != magnitude) return std::numeric_limits<double>::infinity();
            if (magnitude > norm) norm = magnitude;
        }
        return norm;
    }
};

}  // namespace polhode

template <class S>
struct boost::numeric::odeint::is_resizeable<polhode::OdeintArray<polhode::odeint_run_time, S>> : boost::true_type {};
