#include "integrators/odeint/odeint.h"
#include "integrators/odeint/rosenbrock.h"
#include "integrators/run/amplification.h"
#include "motion/jacobian.h"

namespace polhode {
namespace {

/// The system as plain functions with a context pointer that the stepper passes through.
template <class SystemType>
struct SystemContext {
    const SystemType* system;
    long* evaluations;

    static void rhs(void* context, double t, const double* y, double* dydt) {
        const auto* self = static_cast<const SystemContext*>(context);
        ++*self->evaluations;
        self->system->derivative(t, y, dydt);
    }
    // The right-hand side does not depend on time: between events every load of a scene file is constant.
    static void jacobian(void* context, double t, const double* y, double* J) {
        const auto* self = static_cast<const SystemContext*>(context);
        polhode::jacobian(*self->system, t, y, J);
    }
    static PlainSystem make_plain_system(int size) { return {static_cast<std::size_t>(size), rhs, jacobian}; }
};

template <class SystemType>
class FixedRosenbrock : public OdeintState<SystemType> {
    using Base = OdeintState<SystemType>;

  public:
    explicit FixedRosenbrock(const Problem& problem)
        : Base(problem), scheme_(SystemContext<SystemType>::make_plain_system(this->system_.size()), 1, 1) {}
    void step(double t, double h) {
        SystemContext<SystemType> context{&this->system_, &this->evaluations_};
        scheme_.step(&context, t, this->y_.data(), h);
        this->project();
    }

  private:
    Rosenbrock4 scheme_;
};

template <class SystemType>
class ControlledRosenbrock : public ControlledOdeintState<SystemType> {
    using Base = ControlledOdeintState<SystemType>;

  public:
    ControlledRosenbrock(const Problem& problem, double tolerance)
        : Base(problem, tolerance, 4),
          scheme_(SystemContext<SystemType>::make_plain_system(this->system_.size()),
                  tolerance * this->smallest_scale(), tolerance) {}

    void restart() {
        Base::restart();
        scheme_.reset();
    }
    void enter(const Segment& segment) {
        Base::enter(segment);
        scheme_.reset();
    }
    Attempt attempt(double& t, double& h) {
        const double tried = h;
        OdeintArray<Base::N> next = this->y_;
        SystemContext<SystemType> context{&this->system_, &this->evaluations_};
        const bool accepted = scheme_.attempt(&context, t, this->y_.data(), next.data(), h);
        if (!all_finite(next) || !std::isfinite(h)) {
            h = not_finite_shrinkage * tried;
            scheme_.reset();
            return Attempt::not_finite;
        }
        if (!accepted) return Attempt::rejected;
        this->y_ = next, t += tried;
        this->project();
        return Attempt::accepted;
    }

  private:
    Rosenbrock4 scheme_;
};

}  // namespace

double rosenbrock4_growth(std::complex<double> z) {
    const PlainSystem linear{2,
                             [](void* context, double, const double* y, double* rate) {
                                 linear_rate(*static_cast<const std::complex<double>*>(context), y, rate);
                             },
                             [](void* context, double, const double*, double* J) {
                                 const auto& c = *static_cast<const std::complex<double>*>(context);
                                 J[0] = J[3] = c.real(), J[1] = -c.imag(), J[2] = c.imag();
                             }};
    double y[2] = {1, 0};
    Rosenbrock4(linear, 1, 1).step(&z, 0, y, 1);
    return magnitude({y[0], y[1]});
}

Trajectory solve_rosenbrock4(const Problem& problem, const Settings& settings) {
    if (settings.tolerance && !is_reachable(*settings.tolerance)) return unreachable_tolerance(*settings.tolerance);
    return with_system(problem, [&]<class SystemType>() {
        if (!settings.tolerance) return march<FixedRosenbrock<SystemType>>(problem, settings);
        return march_controlled(problem, settings, ControlledRosenbrock<SystemType>(problem, *settings.tolerance));
    });
}

}  // namespace polhode
