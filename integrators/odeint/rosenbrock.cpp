// Disables uBLAS checks that multiply out the factors and throw. They assume finite, well-conditioned systems; here
// the caller checks the result.
#define BOOST_UBLAS_NDEBUG
#define BOOST_UBLAS_TYPE_CHECK 0

#include "integrators/odeint/rosenbrock.h"

#include <algorithm>
#include <boost/numeric/odeint/stepper/rosenbrock4.hpp>
#include <boost/numeric/odeint/stepper/rosenbrock4_controller.hpp>
#include <utility>

namespace polhode {
namespace {

namespace odeint = boost::numeric::odeint;
using Stepper = odeint::rosenbrock4<double>;
using Controller = odeint::rosenbrock4_controller<Stepper>;
using Vector = boost::numeric::ublas::vector<double>;
using Matrix = boost::numeric::ublas::matrix<double>;

struct RightHandSide {
    const PlainSystem* system;
    void* context;
    void operator()(const Vector& y, Vector& dydt, double t) const { system->rhs(context, t, &y[0], &dydt[0]); }
};

struct Jacobian {
    const PlainSystem* system;
    void* context;
    void operator()(const Vector& y, Matrix& J, double t, Vector& dfdt) const {
        system->jacobian(context, t, &y[0], &J.data()[0]);
        std::fill(dfdt.begin(), dfdt.end(), 0.0);
    }
};

}  // namespace

struct Rosenbrock4::Implementation {
    Implementation(const PlainSystem& plain, double absolute, double relative)
        : system(plain),
          absolute_tolerance(absolute),
          relative_tolerance(relative),
          controller(absolute, relative),
          y(plain.dimension),
          next(plain.dimension) {}

    std::pair<RightHandSide, Jacobian> bind_context(void* context) const {
        return {RightHandSide{&system, context}, Jacobian{&system, context}};
    }

    PlainSystem system;
    double absolute_tolerance, relative_tolerance;
    Controller controller;
    Vector y, next;
};

Rosenbrock4::Rosenbrock4(const PlainSystem& system, double absolute, double relative)
    : implementation_(std::make_unique<Implementation>(system, absolute, relative)) {}
Rosenbrock4::Rosenbrock4(const Rosenbrock4& other)
    : implementation_(std::make_unique<Implementation>(*other.implementation_)) {}
Rosenbrock4& Rosenbrock4::operator=(const Rosenbrock4& other) {
    if (this != &other) implementation_ = std::make_unique<Implementation>(*other.implementation_);
    return *this;
}
Rosenbrock4::~Rosenbrock4() = default;

void Rosenbrock4::reset() {
    // Recreate the stepper: the controller's memory of its last step cannot be cleared otherwise.
    const Implementation& old = *implementation_;
    implementation_ = std::make_unique<Implementation>(old.system, old.absolute_tolerance, old.relative_tolerance);
}

void Rosenbrock4::step(void* context, double t, double* y, double h) {
    Implementation& i = *implementation_;
    std::copy(y, y + i.system.dimension, i.y.begin());
    i.controller.stepper().do_step(i.bind_context(context), i.y, t, i.next, h);
    std::copy(i.next.begin(), i.next.end(), y);
}

bool Rosenbrock4::attempt(void* context, double t, const double* y, double* next, double& h) {
    Implementation& i = *implementation_;
    std::copy(y, y + i.system.dimension, i.y.begin());
    const bool accepted = i.controller.try_step(i.bind_context(context), i.y, t, i.next, h) == odeint::success;
    std::copy(i.next.begin(), i.next.end(), next);
    return accepted;
}

}  // namespace polhode
