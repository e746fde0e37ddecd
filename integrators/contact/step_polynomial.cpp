#include "integrators/contact/step_polynomial.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace polhode::contact {

ChebyshevPoints::ChebyshevPoints(int m) : m_(m) {
    const std::size_t n = static_cast<std::size_t>(m) + 1;
    for (int j = 0; j <= m; ++j) {
        const double sine = std::sin(std::numbers::pi * j / (2 * m));
        points_.push_back(j == m ? 1 : sine * sine);
    }
    transform_.assign(n * n, 0), powers_.assign(n * n, 0), integrals_.assign(n * n, 0);
    // T_{k+1} = (4 x - 2) T_k - T_{k-1}
    powers_[index(0, 0)] = 1, powers_[index(1, 0)] = -1, powers_[index(1, 1)] = 2;
    for (int k = 2; k <= m; ++k)
        for (int p = 0; p <= k; ++p)
            powers_[index(k, p)] = (p > 0 ? 4 * power(k - 1, p - 1) : 0) - 2 * power(k - 1, p) - power(k - 2, p);
    // c_k = 2/m sum'' of f_j T_k(x_j), where the first and last terms count half; T_k(x_j) = (-1)^k cos(pi j k / m)
    const auto half_at_ends = [&](int i) { return i == 0 || i == m ? 0.5 : 1.0; };
    for (int k = 0; k <= m; ++k)
        for (int j = 0; j <= m; ++j)
            transform_[index(k, j)] = (k % 2 == 0 ? 2.0 : -2.0) / m * half_at_ends(j) * half_at_ends(k) *
                                      std::cos(std::numbers::pi * ((j * k) % (2 * m)) / m);
    find_integrals();
}

// With z = 2 x - 1: the integral of T_k over z is (T_{k+1} / (k + 1) - T_{k-1} / (k - 1)) / 2, of T_1 z^2 / 2.
void ChebyshevPoints::find_integrals() {
    const auto chebyshev = [](int k, double z) { return std::cos(k * std::acos(std::clamp(z, -1.0, 1.0))); };
    const auto primitive = [&](int k, double z) {
        if (k == 0) return z;
        if (k == 1) return z * z / 2;
        return (chebyshev(k + 1, z) / (k + 1) - chebyshev(k - 1, z) / (k - 1)) / 2;
    };
    for (int i = 0; i <= m_; ++i)
        for (int j = 0; j <= m_; ++j) {
            double sum = 0;
            for (int k = 0; k <= m_; ++k)
                sum += transform(k, j) * (primitive(k, 2 * point(i) - 1) - primitive(k, -1)) / 2;
            integrals_[index(i, j)] = sum;
        }
}

const ChebyshevPoints& ChebyshevPoints::of_degree(int m) {
    static const std::vector<ChebyshevPoints> all = [] {
        std::vector<ChebyshevPoints> points;
        for (int degree = 1; degree <= most_degree; ++degree) points.emplace_back(degree);
        return points;
    }();
    return all[static_cast<std::size_t>(std::clamp(m, 1, most_degree) - 1)];
}

void StepPolynomial::fit(const ChebyshevPoints& points, double h, int size,
                         const std::vector<std::vector<double>>& states, const std::vector<std::vector<double>>& rates,
                         double tolerance) {
    const int m = points.count() - 1;
    order_ = m + 1, components_ = static_cast<int>(rates.front().size()), size_ = size, h_ = h;
    start_ = states.front(), end_ = states.back();
    coefficients_.assign(static_cast<std::size_t>(components_) * (static_cast<std::size_t>(order_) + 1), 0);
    chebyshev_ = coefficients_;
    for (int i = 0; i < components_; ++i) {
        const auto at = static_cast<std::size_t>(i);
        const bool is_state = i < size;
        const std::vector<std::vector<double>>& values = is_state ? states : rates;
        const double first = values.front()[at];
        // of differences from the start, which keep the digits of small changes
        for (int k = 0; k <= m; ++k)
            for (int j = 1; j <= m; ++j)
                chebyshev_[index(i, k)] += points.transform(k, j) * (values[static_cast<std::size_t>(j)][at] - first);
        coefficients_[index(i, is_state ? 0 : 1)] = first;
        double largest = 0;
        for (int k = 0; k <= m; ++k) largest = std::max(largest, std::abs(chebyshev_[index(i, k)]));
        int highest = m;
        while (highest > 1 && std::abs(chebyshev_[index(i, highest)]) <= tolerance * largest) --highest;
        double per_power = 1 / h;
        for (int p = 1; p <= highest; ++p) {
            double sum = 0;
            for (int k = p; k <= highest; ++k) sum += chebyshev_[index(i, k)] * points.power(k, p);
            // beyond the range of numbers over a tiny step, whose motion is straight
            if (!std::isfinite(sum * per_power)) break;
            if (is_state)
                coefficients_[index(i, p)] = sum * per_power;
            else
                coefficients_[index(i, p + 1)] = sum * per_power / (p + 1);
            per_power /= h;
        }
    }
}

double StepPolynomial::last_term(int i) const {
    return std::max(std::abs(chebyshev_[index(i, order_ - 1)]), std::abs(chebyshev_[index(i, order_ - 2)]));
}

void StepPolynomial::evaluate(double s, double* y) const {
    std::fill(y + size_, y + components_, 0);
    if (s == h_) {
        std::copy(end_.begin(), end_.end(), y);
        return;
    }
    const double z = 2 * (s / h_) - 1;
    for (int i = 0; i < size_; ++i) {
        double next = 0, after = 0;
        for (int k = order_ - 1; k > 0; --k) {
            const double now = chebyshev_[index(i, k)] + 2 * z * next - after;
            after = next, next = now;
        }
        y[i] = start_[static_cast<std::size_t>(i)] + (chebyshev_[index(i, 0)] + z * next - after);
    }
}

}  // namespace polhode::contact
