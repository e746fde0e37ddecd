// The polynomial of a step of any method, from states and rates at Chebyshev points.
//
// The points are x_j = (1 - cos(pi j / m)) / 2, j = 0 .. m, of a step with s = h x. A polynomial through values at
// these points is expanded in Chebyshev polynomials T_k(2 x - 1) by a cosine transform. Their sum is evaluated by
// Clenshaw's recurrence; coefficients of powers of s, from which events are found, follow from those of T_k, which are
// integers.
#pragma once

#include <cstddef>
#include <vector>

namespace polhode::contact {

/// Interpolation at the m + 1 Chebyshev points of [0, 1].
class ChebyshevPoints {
  public:
    explicit ChebyshevPoints(int m);

    int count() const { return m_ + 1; }
    double point(int j) const { return points_[static_cast<std::size_t>(j)]; }
    /// The coefficient of T_k is the sum of transform(k, j) value_j.
    double transform(int k, int j) const { return transform_[index(k, j)]; }
    /// The coefficient of x^power in T_k(2 x - 1).
    double power(int k, int power) const { return powers_[index(k, power)]; }
    /// The integral from 0 to x_i is the sum of integral(i, j) value_j.
    double integral(int i, int j) const { return integrals_[index(i, j)]; }

    /// The points for a degree m between 1 and most_degree, computed once.
    static const ChebyshevPoints& of_degree(int m);
    static constexpr int most_degree = 14;

  private:
    int m_;
    std::vector<double> points_, transform_, powers_, integrals_;
    std::size_t index(int row, int column) const {
        return static_cast<std::size_t>(row) * (static_cast<std::size_t>(m_) + 1) + static_cast<std::size_t>(column);
    }
    void find_integrals();
};

/// Polynomials in s of all components over a step of length h. The components after the state are integrals of
/// functions, whose values are known.
class StepPolynomial {
  public:
    /// Degree in s.
    int order() const { return order_; }
    /// The coefficient of s^k.
    double coefficient(int i, int k) const { return coefficients_[index(i, k)]; }
    /// The state at s, and zero for the other components. The end of the step is reproduced exactly.
    void evaluate(double s, double* y) const;

    /// Fits `states` (size components each) and `rates` (all components each) at the points of a step of length h,
    /// which starts at the first and ends at the last of the states. Coefficients of powers omit terms below
    /// `tolerance` times the largest one, because high Chebyshev polynomials have large coefficients.
    void fit(const ChebyshevPoints& points, double h, int size, const std::vector<std::vector<double>>& states,
             const std::vector<std::vector<double>>& rates, double tolerance);
    /// The largest coefficient of T_(m-1) and T_m of a state.
    double last_term(int i) const;

  private:
    int order_ = 0, components_ = 0, size_ = 0;
    double h_ = 0;
    std::vector<double> chebyshev_, coefficients_, start_, end_;
    std::size_t index(int i, int k) const {
        return static_cast<std::size_t>(i) * (static_cast<std::size_t>(order_) + 1) + static_cast<std::size_t>(k);
    }
};

}  // namespace polhode::contact
