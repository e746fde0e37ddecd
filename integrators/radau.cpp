// Radau IIA of 3, 5 and 7 stages with the stages side by side in vector registers.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <type_traits>

#include "integrators/kernels/four_systems.h"
#include "integrators/kernels/radau_coefficients.h"
#include "integrators/kernels/stages.h"
#include "integrators/march.h"
#include "motion/dual.h"

namespace polhode {
namespace {

double knob(const char* name, double otherwise) {
    const char* text = std::getenv(name);
    return text ? std::atof(text) : otherwise;
}

/// One step's equations Z = h (A x I) f(y + Z) and the simplified Newton iteration that solves them.
template <class SystemType>
struct Equations {
    static constexpr int N = SystemType::dimension;

    double y[N];           ///< at the step's start
    double weight[N];      ///< 1 / (tolerated error)
    double J[N * N];
    FourSystems<N> matrix;  ///< eigenvalue / h - J
    Stages Z[N];            ///< y at the stages less y at the start
};

template <class SystemType>
[[gnu::always_inline]] inline void factor(Equations<SystemType>& e, const RadauCoefficients& radau, double h) {
    const double per_h = 1 / h;
    e.matrix.factor({radau.eigenvalue.re * per_h, radau.eigenvalue.im * per_h}, e.J);
}

/// (I - h A x J) dZ = h (A x I) f(y + Z) - Z, Z += dZ. The root mean square of dZ over all stages, weighted.
template <class SystemType>
[[gnu::always_inline]] inline double iterate(Equations<SystemType>& e, const SystemType& system,
                                             const RadauCoefficients& radau, double t, double h) {
    constexpr int N = SystemType::dimension;
    const int s = radau.stages;
    const double per_h = 1 / h;
    Stages Y[N], F[N];
    for (int n = 0; n < N; ++n) Y[n] = e.y[n] + e.Z[n];
    system.derivative(t, Y, F);
    Complex4 W[N];
    for (int n = 0; n < N; ++n) {
        // A F - Z / h, then Lambda T^-1 of it
        Lanes8 residual = -per_h * e.Z[n].lane, transformed{};
        for (int j = 0; j < s; ++j) residual += F[n].lane[j] * radau.a[j];
        for (int j = 0; j < s; ++j) transformed += residual[j] * radau.inward[j];
        W[n].re = __builtin_shufflevector(transformed, transformed, 0, 1, 2, 3);
        W[n].im = __builtin_shufflevector(transformed, transformed, 4, 5, 6, 7);
    }
    e.matrix.solve(W);
    Lanes8 squares{};
    for (int n = 0; n < N; ++n) {
        Lanes8 change{};
        for (int k = 0; k < 4; ++k) change += W[n].re[k] * radau.outward[k];
        for (int k = 0; k < 3; ++k) change += W[n].im[k] * radau.outward[4 + k];
        e.Z[n].lane += change;
        const Lanes8 weighted = e.weight[n] * change;
        squares += weighted * weighted;
    }
    double sum = 0;
    for (int j = 0; j < 8; ++j) sum += squares[j];
    return std::sqrt(sum / (N * s));
}

/// x := (gamma / h - J)^-1 x with the real eigenvalue gamma.
template <class SystemType>
[[gnu::always_inline]] inline void solve_real(const Equations<SystemType>& e, double* x) {
    constexpr int N = SystemType::dimension;
    Complex4 W[N];
    for (int n = 0; n < N; ++n) W[n].re = Lanes4{0, 0, 0, x[n]};
    e.matrix.solve(W);
    for (int n = 0; n < N; ++n) x[n] = W[n].re[3];
}

/// The kernel in the instructions of one set.
template <class SystemType>
struct Kernel {
    void (*factor)(Equations<SystemType>&, const RadauCoefficients&, double h);
    double (*iterate)(Equations<SystemType>&, const SystemType&, const RadauCoefficients&, double t, double h);
    void (*solve_real)(const Equations<SystemType>&, double*);
};

#define POLHODE_KERNEL(TARGET, NAME)                                                                              \
    template <class SystemType>                                                                                   \
    struct NAME {                                                                                                 \
        TARGET [[gnu::flatten]] static void factored(Equations<SystemType>& e, const RadauCoefficients& r,        \
                                                     double h) {                                                  \
            factor(e, r, h);                                                                                      \
        }                                                                                                         \
        TARGET [[gnu::flatten]] static double iterated(Equations<SystemType>& e, const SystemType& system,        \
                                                       const RadauCoefficients& r, double t, double h) {          \
            return iterate(e, system, r, t, h);                                                                   \
        }                                                                                                         \
        TARGET [[gnu::flatten]] static void solved(const Equations<SystemType>& e, double* x) { solve_real(e, x); } \
        static constexpr Kernel<SystemType> kernel{factored, iterated, solved};                                   \
    };
POLHODE_KERNEL(, PlainKernel)
POLHODE_KERNEL(POLHODE_TARGET_AVX2, Avx2Kernel)
POLHODE_KERNEL(POLHODE_TARGET_AVX512, Avx512Kernel)
#undef POLHODE_KERNEL

template <class SystemType>
const Kernel<SystemType>& kernel_for(InstructionSet set) {
    switch (set) {
        case InstructionSet::avx2:
            return Avx2Kernel<SystemType>::kernel;
        case InstructionSet::avx512:
            return Avx512Kernel<SystemType>::kernel;
        case InstructionSet::plain:
            break;
    }
    return PlainKernel<SystemType>::kernel;
}

template <class SystemType>
class Radau {
  public:
    static constexpr int N = SystemType::dimension;

    Radau(const Problem& problem, double tolerance, int stages)
        : problem_(&problem),
          system_(system_on<SystemType>(problem, problem.segments.front())),
          kernel_(kernel_for<SystemType>(instruction_set())),
          radau_(&radau_coefficients(stages)) {
        component_scales<SystemType>(problem, scales_);
        const double s = stages;
        inner_ = std::min(0.1, knob("FACTOR", 0.1) * std::pow(tolerance, knob("EXPO", 0) ? knob("EXPO", 0) : (s + 1) / (2 * s)));
        newton_ = std::max(10 * epsilon / inner_, std::min(0.03, knob("NEWT", 1) * std::sqrt(inner_)));
        most_ = static_cast<int>(7 + (s - 3) * 2.5);
        restart();
    }
    void restart() {
        initial_state<SystemType>(*problem_, y_);
        for (double& c : carry_) c = 0;
        evaluations_ = 0;
        forget();
    }
    void enter(const Segment& segment) {
        if (polhode::enter<SystemType>(*problem_, segment, y_))
            for (double& c : carry_) c = 0;
        system_ = system_on<SystemType>(*problem_, segment);
        forget();
    }
    Sample sample(double t) const { return sample_of<SystemType>(*problem_, t, y_); }
    bool finite() const {
        double sum = 0;
        for (double value : y_) sum += value * 0;
        return sum == 0;
    }
    long rhs_evaluations() const { return evaluations_; }

    double first_step(double t) {
        double f1[N], z[N];
        weigh();
        evaluate(t);
        const double d0 = norm(y_), d1 = norm(f0_);
        const double guess = d0 < 1e-5 || d1 < 1e-5 ? 1e-6 : 0.01 * d0 / d1;
        for (int i = 0; i < N; ++i) z[i] = y_[i] + guess * f0_[i];
        system_.derivative(t + guess, z, f1);
        ++evaluations_;
        for (int i = 0; i < N; ++i) f1[i] = f1[i] - f0_[i];
        const double steepest = std::max(d1, norm(f1) / guess);
        const double h = steepest <= 1e-15 ? std::max(1e-6, guess * 1e-3)
                                           : std::pow(0.01 / steepest, 1.0 / (radau_->stages + 1));
        const double step = std::min(100 * guess, h);
        return step > 0 && std::isfinite(step) ? step : 1e-6 * problem_->scene.duration;
    }

    Attempt attempt(double& t, double& h) {
        const int s = radau_->stages;
        weigh();
        if (!fresh_) evaluate(t);
        start(h);
        kernel_.factor(e_, *radau_, h);
        double last = 0, rate = 0, factor = std::pow(std::max(faccon_, epsilon), 0.8);
        int iteration = 0;
        bool converged = false;
        for (; iteration < most_; ++iteration) {
            const double change = kernel_.iterate(e_, system_, *radau_, t, h);
            evaluations_ += s;
            if (!std::isfinite(change)) {
                h *= 0.1;
                return Attempt::not_finite;
            }
            if (iteration > 0) {
                const double now = change / last;
                rate = iteration == 1 ? now : std::sqrt(now * rate_before_);
                rate_before_ = now;
                if (rate < 0.99) {
                    factor = rate / (1 - rate);
                    const double ahead = factor * change * std::pow(rate, most_ - 2 - iteration) / newton_;
                    if (ahead >= 1 && change > newton_) {
                        h *= 0.8 * std::pow(std::max(1e-4, std::min(20.0, ahead)), -1.0 / (4 + most_ - 2 - iteration));
                        return Attempt::rejected;
                    }
                } else if (change > newton_) {
                    h *= 0.5;
                    return Attempt::rejected;
                }
            }
            last = change;
            if (factor * change <= newton_ || change == 0) {
                converged = true;
                break;
            }
        }
        if (!converged) {
            h *= 0.5;
            return Attempt::rejected;
        }
        faccon_ = factor;

        // f(y) less the polynomial's derivative there, filtered
        double error[N];
        for (int n = 0; n < N; ++n) {
            double slope = 0;
            for (int j = 0; j < s; ++j) slope += radau_->slope_at_0[j] * e_.Z[n].lane[j];
            error[n] = defect_[n] = -slope / h;
            error[n] += f0_[n];
        }
        kernel_.solve_real(e_, error);
        double err = norm(error);
        if (err >= 1 && (first_ || rejected_)) {
            double z[N], f[N];
            for (int n = 0; n < N; ++n) z[n] = y_[n] + error[n];
            system_.derivative(t, z, f);
            ++evaluations_;
            for (int n = 0; n < N; ++n) error[n] = f[n] + defect_[n];
            kernel_.solve_real(e_, error);
            err = norm(error);
        }
        if (!std::isfinite(err)) {
            h *= 0.1;
            return Attempt::not_finite;
        }
        err = std::max(err, 1e-10);
        const double safety = std::min(0.9, 0.9 * (1 + 2.0 * most_) / (iteration + 1 + 2 * most_));
        const double power = 1.0 / (s + 1);
        double ratio = std::clamp(safety * std::pow(err, -power), 0.125, knob("GROW", 8));
        if (err >= 1) {
            h *= first_ ? 0.1 : ratio;
            rejected_ = true;
            return Attempt::rejected;
        }
        // Gustafsson's prediction
        if (!first_) {
            const double predicted = 0.9 * (h / h_before_) * std::pow(err * err / err_before_, -power);
            ratio = std::min(ratio, std::clamp(predicted, 0.125, 8.0));
        }
        if (rejected_) ratio = std::min(ratio, 1.0);
        err_before_ = std::max(err, 1e-2), h_before_ = h;
        for (int n = 0; n < N; ++n) {
            // compensated
            const double change = e_.Z[n].lane[s - 1] + carry_[n], sum = y_[n] + change;
            carry_[n] = change - (sum - y_[n]);
            y_[n] = sum;
        }
        if (knob("TRACE", 0)) std::fprintf(stderr, "t %g h %g it %d rate %g err %g\n", t, h, iteration + 1, rate, err);
        keep_polynomial();
        t += h;
        h *= ratio;
        first_ = rejected_ = fresh_ = false;
        return Attempt::accepted;
    }

  private:
    static constexpr double epsilon = std::numeric_limits<double>::epsilon();

    void forget() { first_ = true, rejected_ = false, fresh_ = false, known_ = false, faccon_ = 1; }
    void weigh() {
        for (int i = 0; i < N; ++i) e_.y[i] = y_[i], e_.weight[i] = 1 / (inner_ * (scales_[i] + std::abs(y_[i])));
    }
    void evaluate(double t) {
        system_.derivative(t, y_, f0_);
        ++evaluations_;
        fresh_ = true;
    }
    double norm(const double* v) const {
        double sum = 0;
        for (int i = 0; i < N; ++i) sum += (v[i] * e_.weight[i]) * (v[i] * e_.weight[i]);
        return std::sqrt(sum / N);
    }
    void keep_polynomial() {
        const int s = radau_->stages;
        for (int n = 0; n < N; ++n) {
            polynomial_[n] = Lanes8{};
            for (int j = 0; j < s; ++j) polynomial_[n] += e_.Z[n].lane[j] * radau_->power[j];
        }
        known_ = true;
    }
    void start(double h) {
        const int s = radau_->stages;
        const double r = h / h_before_;
        const bool use = known_ && r <= knob("RMAX", 4);
        if (use) {
            const Lanes8 x = r * radau_->nodes;
            for (int n = 0; n < N; ++n) {
                Lanes8 sum{};
                for (int k = s; k-- > 0;) sum = (sum + polynomial_[n][k]) * x;
                e_.Z[n].lane = sum;
            }
        } else {
            for (int n = 0; n < N; ++n) e_.Z[n] = Stages();
        }
        double at[N];
        const double x = r * knob("JAT", 0.5);
        for (int n = 0; n < N; ++n) {
            double sum = 0;
            if (use)
                for (int k = s; k-- > 0;) sum = (sum + polynomial_[n][k]) * x;
            at[n] = y_[n] + sum;
        }
        jacobian(system_, 0, at, e_.J);
    }

    const Problem* problem_;
    SystemType system_;
    Kernel<SystemType> kernel_;
    const RadauCoefficients* radau_;
    double scales_[N], inner_, newton_;
    int most_;
    Equations<SystemType> e_;
    double y_[N], carry_[N], f0_[N], defect_[N];
    Lanes8 polynomial_[N];
    double rate_before_ = 1, faccon_ = 1, err_before_ = 1, h_before_ = 1;
    bool first_ = true, rejected_ = false, fresh_ = false, known_ = false;
    long evaluations_ = 0;
};

Trajectory solve_radau(const Problem& problem, const Settings& settings) {
    if (problem.needs.user_torque) return unsupported("a torque of the user's own has no Jacobian");
    return with_system(problem, [&]<class SystemType>() {
        return march_controlled(problem, settings, Radau<SystemType>(problem, *settings.tolerance, (int)knob("STAGES", 7)));
    });
}

constexpr Method list[] = {
    {.name = "radau",
     .documentation = "Radau IIA",
     .source = "Hairer & Wanner 1999",
     .conserves = "nothing",
     .control = Control::tolerance,
     .solve = solve_radau},
};

}  // namespace

extern const std::span<const Method> radau_methods;
const std::span<const Method> radau_methods{list};

}  // namespace polhode
