// Boost.Odeint's rosenbrock4 behind plain doubles. It uses uBLAS, which compiles only as C++17 (it calls an allocator
// function that C++20 removed). This header includes nothing beyond C++17, so that both sides can include it.
#pragma once

#include <cstddef>
#include <memory>

namespace polhode {

/// dy/dt = f(y) with `dimension` components, as plain functions of a context; Jacobian row by row. There is no df/dt:
/// with one, the method of Boost 1.74 has only order 1, because its coefficient d4 lacks the minus sign of RODAS
/// (Hairer & Wanner 1996, IV.7; measured: with the sign it has order 4).
struct PlainSystem {
    std::size_t dimension;
    void (*rhs)(void* context, double t, const double* y, double* dydt);
    void (*jacobian)(void* context, double t, const double* y, double* J);
};

/// Odeint's rosenbrock4 and its controller. Copies are independent.
class Rosenbrock4 {
  public:
    /// err = root mean square of error_i / (absolute + relative max(|y_i|, |y_i new|)). Fixed steps ignore the
    /// tolerances.
    Rosenbrock4(const PlainSystem& system, double absolute, double relative);
    Rosenbrock4(const Rosenbrock4& other);
    Rosenbrock4& operator=(const Rosenbrock4& other);
    ~Rosenbrock4();

    /// Clears the controller's history.
    void reset();
    /// Takes one step of size h in place.
    void step(void* context, double t, double* y, double h);
    /// Tries a step of size h from y. Returns true if it is accepted; sets h to the proposed next size and `next` to
    /// the result.
    bool attempt(void* context, double t, const double* y, double* next, double& h);

  private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

}  // namespace polhode
