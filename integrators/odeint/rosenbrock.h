// Boost.Odeint's rosenbrock4 behind plain doubles. uBLAS, on which it stands, compiles only as C++17 (it calls an
// allocator function that C++20 removed); this header includes nothing that needs more, so that both sides may.
#pragma once

#include <cstddef>
#include <memory>

namespace polhode {

/// dy/dt = f(y) of `dimension` components as plain functions of a context; Jacobian row by row. There is no df/dt: with
/// one, Boost 1.74's method is of order 1 only, for its coefficient d4 lacks the minus sign of RODAS (Hairer & Wanner
/// 1996, IV.7; measured: with the sign it is of order 4).
struct PlainSystem {
    std::size_t dimension;
    void (*rhs)(void* context, double t, const double* y, double* dydt);
    void (*jacobian)(void* context, double t, const double* y, double* J);
};

/// Odeint's rosenbrock4 and its controller. Copies go on independently.
class Rosenbrock4 {
  public:
    /// err = root mean square of error_i / (absolute + relative max(|y_i|, |y_i new|)); for fixed steps the
    /// tolerances do not matter.
    Rosenbrock4(const PlainSystem& system, double absolute, double relative);
    Rosenbrock4(const Rosenbrock4& other);
    Rosenbrock4& operator=(const Rosenbrock4& other);
    ~Rosenbrock4();

    /// Forgets the controller's history.
    void reset();
    /// One step of size h in place.
    void step(void* context, double t, double* y, double h);
    /// Tries a step of size h from y: true if it is accepted; h is the size proposed next. `next` is what was tried.
    bool attempt(void* context, double t, const double* y, double* next, double& h);

  private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

}  // namespace polhode
