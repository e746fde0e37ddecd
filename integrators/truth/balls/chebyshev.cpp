#include "integrators/truth/balls/chebyshev.h"

#include <algorithm>
#include <limits>

namespace polhode::truth {
namespace {

// cos(pi numerator / denominator)
Ball cosine(long numerator, long denominator) {
    Ball c;
    fmpq_t x;
    fmpq_init(x);
    fmpq_set_si(x, numerator, static_cast<ulong>(denominator));
    arb_cos_pi_fmpq(c.raw(), x, Ball::precision());
    fmpq_clear(x);
    return c;
}

void add_scaled(ChebyshevSeries& sum, const Ball& factor, const ChebyshevSeries& a) {
    if (sum.size() < a.size()) sum.resize(a.size());
    for (std::size_t k = 0; k < a.size(); ++k) sum[k] += factor * a[k];
}

}  // namespace

Ball chebyshev_point(int i, int m) { return cosine(2L * i + 1, 2L * m); }

ChebyshevSeries interpolated(const std::vector<Ball>& values) {
    const long m = static_cast<long>(values.size());
    ChebyshevSeries series(values.size());
    for (long k = 0; k < m; ++k) {
        for (long i = 0; i < m; ++i) series[k] += values[i] * cosine((2 * i + 1) * k % (4 * m), 2 * m);
        series[k] *= Ball(k == 0 ? 1 : 2) / Ball(m);
    }
    return series;
}

ChebyshevSeries product(const ChebyshevSeries& a, const ChebyshevSeries& b) {
    if (a.empty() || b.empty()) return {};
    ChebyshevSeries c(a.size() + b.size() - 1);
    for (std::size_t i = 0; i < a.size(); ++i)
        for (std::size_t j = 0; j < b.size(); ++j) {
            const Ball term = a[i] * b[j];
            c[i + j] += term;
            c[i > j ? i - j : j - i] += term;
        }
    double largest = -std::numeric_limits<double>::infinity();
    for (Ball& term : c) {
        term *= Ball(0.5);
        largest = std::max(largest, Bound(term).log2_near());
    }
    Bound cut;
    while (c.size() > 1 && Bound(c.back()).log2_near() < largest - static_cast<double>(Ball::precision())) {
        cut += Bound(c.back());
        c.pop_back();
    }
    c[0] = widened(std::move(c[0]), cut);
    return c;
}

ChebyshevSeries derivative(const ChebyshevSeries& a) {
    const std::size_t n = a.size();
    if (n < 2) return {};
    ChebyshevSeries d(n + 1);
    for (std::size_t k = n - 1; k >= 1; --k) d[k - 1] = d[k + 1] + Ball(2 * k) * a[k];
    d[0] *= Ball(0.5);
    d.resize(n - 1);
    return d;
}

Ball value_at(const ChebyshevSeries& a, const Ball& x) {
    Ball later, last;
    const Ball twice = x + x;
    for (std::size_t k = a.size(); k-- > 1;) {
        Ball now = a[k] + twice * last - later;
        later = std::move(last);
        last = std::move(now);
    }
    return a.empty() ? Ball() : a[0] + x * last - later;
}

Bound sum_of(const ChebyshevSeries& a) {
    Bound sum;
    for (const Ball& c : a) sum += Bound(c);
    return sum;
}

Bound slope_of(const ChebyshevSeries& a) {
    Bound sum;
    for (std::size_t k = 1; k < a.size(); ++k) sum += Bound(static_cast<double>(k * k)) * Bound(a[k]);
    return sum;
}

std::vector<ChebyshevSeries> rates_along(const Recording<Ball>& recording, const std::vector<ChebyshevSeries>& states) {
    using Kind = TapeNode<Ball>::Kind;
    std::vector<ChebyshevSeries> node;
    for (const TapeNode<Ball>& n : recording.tape.nodes) {
        if (n.kind == Kind::state) {
            node.push_back(states[node.size()]);
        } else if (n.kind == Kind::product) {
            node.push_back(product(node[n.a], node[n.b]));
        } else {
            ChebyshevSeries sum(1);
            add_scaled(sum, n.factor_a, node[n.a]);
            if (n.b >= 0)
                add_scaled(sum, n.factor_b, node[n.b]);
            else
                sum[0] += n.factor_b;
            node.push_back(std::move(sum));
        }
    }
    std::vector<ChebyshevSeries> rates;
    for (const Traced<Ball>& rate : recording.rates) {
        ChebyshevSeries sum(1);
        if (rate.node >= 0)
            add_scaled(sum, rate.factor, node[rate.node]);
        else
            sum[0] = rate.factor;
        rates.push_back(std::move(sum));
    }
    return rates;
}

}  // namespace polhode::truth
