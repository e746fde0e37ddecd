// Radau IIA collocation for stiff motion: implicit, of high order, in multiprecision.
//
// CollocationStep solves the stage equations by Newton's iteration. The residual is computed in the working precision;
// the Jacobian is assembled and factored in double. This is iterative refinement, which gains about ten digits per
// iteration. collocate() controls the step by the last Legendre coefficients of the collocation polynomial.
// collocation() follows a scene from event to event. See E. Hairer and G. Wanner, Solving ODEs II, IV.5 and IV.8.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "integrators/series/linear_algebra.h"
#include "integrators/series/radau_nodes.h"
#include "integrators/truth/taylor.h"
#include "motion/dual.h"

namespace polhode::truth {

struct CollocationSettings {
    int stages;
    double digits;  ///< bound of the polynomial's last Legendre coefficients: 10^-digits of each block's scale
    long max_steps;
};

/// One integration step with its working storage. form_ computes in multiprecision, linear_ in double.
template <class P, template <class> class FormOf>
class CollocationStep {
  public:
    CollocationStep(const Scene& scene, int stages)
        : form_(scene), linear_(scene), n_(form_.dimension()), table_(stages), state_(n_, P(0)) {
        const int s = stages;
        a_ = Eigen::MatrixXd(s, s);
        for (int i = 0; i < s; ++i)
            for (int j = 0; j < s; ++j) a_(i, j) = table_.a[i * s + j].template convert_to<double>();
        values_.assign(static_cast<std::size_t>(s + 1) * n_, P(0));
        rates_.assign(static_cast<std::size_t>(s) * n_, P(0));
        residual_ = rates_;
    }

    FormOf<P>& form() { return form_; }
    int dimension() const { return n_; }
    int stages() const { return table_.stages; }

    void enter(double begin) {
        std::vector<double> unused(n_, 0.0);
        unused[3] = 1;
        linear_.enter(begin, unused.data());
    }

    /// Estimate of the fastest rate, 1/s: the largest row sum of |J| at y, with variables in units of their scales.
    double fastest_rate(const std::vector<P>& y, const std::vector<double>& scales) const {
        return (rows(y.data(), scales).cwiseAbs().rowwise().sum()).maxCoeff();
    }

    /// Solves the stage equations for a step h from y. Returns false if Newton's iteration does not converge.
    bool solve(const std::vector<P>& y, const P& h, const std::vector<double>& scales, double digits) {
        const int s = table_.stages;
        for (int i = 0; i <= s; ++i) std::copy(y.begin(), y.end(), values_.begin() + i * n_);
        double last = std::numeric_limits<double>::infinity();
        for (int iteration = 0; iteration < 40 && !Allowance::is_spent(); ++iteration) {
            find_residual(h);
            if (last > 1e-5) factor(h.template convert_to<double>(), scales);
            const double correction = correct(scales);
            if (!std::isfinite(correction)) return false;
            // linear convergence: the remaining error is far below the last correction
            if (correction <= std::pow(10.0, -digits)) return true;
            if (iteration > 3 && correction > 0.5 * last) return false;
            last = correction;
        }
        return false;
    }

    /// Evaluates the collocation polynomial at t + theta h.
    void evaluate(const P& theta, P* y) const {
        const std::vector<P> basis = table_.basis(theta);
        for (int i = 0; i < n_; ++i) {
            P sum(0), scratch(0);
            for (int j = 0; j <= table_.stages; ++j) add_product(sum, basis[j], values_[j * n_ + i], scratch);
            y[i] = sum;
        }
    }

    /// log2 of the larger of the polynomial's last two Legendre coefficients, relative to the scale of each block.
    double log2_tail(const std::vector<Block>& blocks) const {
        double largest = -std::numeric_limits<double>::infinity();
        for (const std::vector<P>* row : {&table_.last, &table_.last_but_one})
            for (const Block& block : blocks) {
                const double size = log2_size(block, [&](int i) {
                    P sum(0), scratch(0);
                    for (int j = 0; j <= table_.stages; ++j) add_product(sum, (*row)[j], values_[j * n_ + i], scratch);
                    return sum;
                });
                largest = std::max(largest, size - std::log2(block.scale));
            }
        return largest;
    }

  private:
    FormOf<P> form_;
    FormOf<double> linear_;
    int n_;
    RadauNodes<P> table_;
    Eigen::MatrixXd a_;
    std::vector<P> state_, values_, rates_, residual_;  // values at the table's nodes; rates and residual at the stages
    Eigen::PartialPivLU<Eigen::MatrixXd> factors_;
    Eigen::VectorXd row_scales_;

    // residual_i = Y_i - y - h sum_j a_ij f(Y_j)
    void find_residual(const P& h) {
        const int s = table_.stages;
        for (int j = 0; j < s; ++j) form_.derivative(&values_[(j + 1) * n_], &rates_[j * n_]);
        P sum(0), scratch(0);
        for (int i = 0; i < s; ++i)
            for (int k = 0; k < n_; ++k) {
                sum = P(0);
                for (int j = 0; j < s; ++j) add_product(sum, table_.a[i * s + j], rates_[j * n_ + k], scratch);
                residual_[i * n_ + k] = values_[(i + 1) * n_ + k] - values_[k] - h * sum;
            }
    }

    // sized for all 13 variables; those that a scene with a pivot does not use stay zero
    struct Linearized {
        static constexpr int dimension = 13;
        const FormOf<double>& form;
        void derivative(double, const Dual<13>* state, Dual<13>* rate) const { form.derivative(state, rate); }
    };

    // the Jacobian, with variables in units of their scales
    Eigen::MatrixXd rows(const P* y, const std::vector<double>& scales) const {
        double rounded[13] = {}, entries[13 * 13];
        for (int i = 0; i < n_; ++i) rounded[i] = y[i].template convert_to<double>();
        jacobian(Linearized{linear_}, 0, rounded, entries);
        Eigen::MatrixXd J = Eigen::Map<Eigen::Matrix<double, 13, 13, Eigen::RowMajor>>(entries).topLeftCorner(n_, n_);
        for (int i = 0; i < n_; ++i)
            for (int j = 0; j < n_; ++j) J(i, j) *= scales[j] / scales[i];
        return J;
    }

    // factors 1 - h A (x) J, each row scaled to a largest entry of 1
    void factor(double h, const std::vector<double>& scales) {
        const Eigen::Index s = table_.stages, n = n_;
        Eigen::MatrixXd M = Eigen::MatrixXd::Identity(s * n, s * n);
        for (int j = 0; j < s; ++j) {
            const Eigen::MatrixXd J = rows(&values_[(j + 1) * n_], scales);
            for (int i = 0; i < s; ++i) M.block(i * n, j * n, n, n) -= (h * a_(i, j)) * J;
        }
        row_scales_ = M.cwiseAbs().rowwise().maxCoeff().cwiseInverse();
        factors_.compute(row_scales_.asDiagonal() * M);
    }

    // applies one Newton correction; returns its largest component relative to its scale
    double correct(const std::vector<double>& scales) {
        const int count = table_.stages * n_;
        // a common power of two keeps the residual within the range of double
        double log2_largest = -std::numeric_limits<double>::infinity();
        for (const P& r : residual_) log2_largest = std::max(log2_largest, log2_magnitude(r));
        if (log2_largest == -std::numeric_limits<double>::infinity()) return 0;
        if (!std::isfinite(log2_largest)) return log2_largest;
        const int shift = static_cast<int>(log2_largest);
        Eigen::VectorXd right(count);
        for (int i = 0; i < count; ++i)
            right[i] = P(ldexp(residual_[i], -shift)).template convert_to<double>() / scales[i % n_];
        const Eigen::VectorXd step = factors_.solve((row_scales_.asDiagonal() * right).eval());
        for (int i = 0; i < count; ++i) values_[n_ + i] -= ldexp(P(step[i] * scales[i % n_]), shift);
        return std::ldexp(step.cwiseAbs().maxCoeff(), shift);
    }
};

/// Integrates y from `begin` to `end` with steps controlled by the polynomial's last coefficients. Calls accept(t,
/// reached, h) after each step, while `step` holds the polynomial and y is still at t. Returns a fault, or "".
template <class P, template <class> class FormOf, class Accept>
std::string collocate(CollocationStep<P, FormOf>& step, double begin, double end, std::vector<P>& y,
                      std::vector<Block>& blocks, const CollocationSettings& settings, long& steps, Accept&& accept) {
    std::vector<double> scales(step.dimension());
    const auto measure = [&] {
        for (Block& block : blocks) {
            const double size = std::exp2(log2_size(block, [&](int i) -> const P& { return y[i]; }));
            block.scale = std::max(block.scale, size);
            std::fill_n(scales.begin() + block.first, block.size, block.scale);
        }
    };
    measure();
    const double allowed = -settings.digits * std::log2(10.0);
    double h = 1 / step.fastest_rate(y, scales);
    P t(begin);
    while (t < end) {
        if (steps++ >= settings.max_steps) return "the step limit is reached";
        if (Allowance::is_spent()) return Allowance::fault;
        measure();
        const P remaining = P(end) - t;
        const bool to_end = remaining <= h;
        const P exact_h = to_end ? remaining : P(h);
        const P reached = to_end ? P(end) : t + exact_h;
        if (!std::isfinite(h) || reached <= t) return "step size below the spacing of numbers";
        if (!step.solve(y, exact_h, scales, settings.digits + 4)) {
            h = exact_h.template convert_to<double>() / 4;
            continue;
        }
        const double excess = (step.log2_tail(blocks) - allowed) / settings.stages;
        const double tried = exact_h.template convert_to<double>();
        h = tried * std::clamp(0.9 * std::exp2(-excess), 0.1, 3.0);
        if (excess > 0) continue;
        accept(t, reached, exact_h);
        step.evaluate(P(1), y.data());
        t = reached;
    }
    return "";
}

/// Follows a scene. on_step(t, h, step) receives the polynomial of the step from t to t + h.
template <class P, template <class> class FormOf, class OnStep = IgnoreStep>
Run<P> collocation(const Scene& scene, const std::vector<double>& sample_times, const Scales& given,
                   const Vector3<double>& moments, const CollocationSettings& settings, const OnStep& on_step = {}) {
    Run<P> run;
    CollocationStep<P, FormOf> step(scene, settings.stages);
    const int n = step.dimension();
    std::vector<P> y(n), at_sample(n);
    std::vector<Block> blocks = step.form().blocks(given, moments);
    SampleQueue samples(sample_times);

    const auto enter = [&](const Leg& leg) {
        step.form().enter(leg.begin, y.data());
        step.enter(leg.begin);
        return true;
    };
    const auto show = [&](double) {
        run.motions.push_back(step.form().motion(y.data()));
        return true;
    };
    step.form().initial(y.data());
    follow(itinerary(scene), samples, enter, show, [&](const Leg& leg) {
        const auto emit = [&](const P& t, const P& reached, const P& h) {
            on_step(t, h, step);
            for (; samples.due(leg, reached); samples.pop()) {
                step.evaluate((P(samples.front()) - t) / h, at_sample.data());
                run.motions.push_back(step.form().motion(at_sample.data()));
            }
        };
        run.fault = collocate(step, leg.begin, leg.end, y, blocks, settings, run.steps, emit);
        return run.fault.empty();
    });
    return run;
}

}  // namespace polhode::truth
