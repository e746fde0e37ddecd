// The state and the algebra that Boost.Odeint's steppers run on here: arrays of a fixed size, whose loops the compiler
// writes out (RK4 step of a free body 43 ns; with loops unrolled by hand 90), and a norm that is infinite where it is
// not a number, so that no step with one in it is ever accepted.
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

#include "motion/own_system.h"

namespace polhode {

/// N numbers, zero at first: Odeint's steppers copy their scratch space before they have written to it.
template <std::size_t N, class S = double>
struct OdeintArray : std::array<S, N> {
    static constexpr std::size_t dimension = N;

    OdeintArray() : std::array<S, N>{} {}
    explicit OdeintArray(int) : OdeintArray() {}
};

/// N where only the running program knows it: Odeint gives its scratch space the size of the state.
inline constexpr std::size_t odeint_run_time = static_cast<std::size_t>(run_time);
template <class S>
struct OdeintArray<odeint_run_time, S> : std::vector<S> {
    OdeintArray() = default;
    explicit OdeintArray(int n) : std::vector<S>(static_cast<std::size_t>(n)) {}
};

/// Odeint's loops over arrays of a fixed size or over ranges, with that norm.
template <std::size_t N>
struct OdeintAlgebra : std::conditional_t<N == odeint_run_time, boost::numeric::odeint::range_algebra,
                                          boost::numeric::odeint::array_algebra> {
    /// The largest magnitude; infinite where a component is not a number.
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
