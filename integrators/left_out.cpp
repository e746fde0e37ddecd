// What was considered and left out.
#include "integrators/method.h"

namespace polhode {
namespace {

constexpr MethodLeftOut left_out[] = {
    {.name = "odeint_symplectic",
     .reason =
         "Odeint's symplectic steppers (`symplectic_euler`, `symplectic_rkn_sb3a_mclachlan`, "
         "`symplectic_rkn_sb3a_m4_mclachlan`) and its `velocity_verlet` integrate dq/dt = f(p), dp/dt = g(q). A rigid "
         "body's motion has no such form: in canonical coordinates of the attitude the kinetic energy depends on the "
         "coordinates beside the momenta, and in Euler's equations, dL/dt = L x I^-1 L, the momenta drive themselves. "
         "Applied to (q, w) all the same they would be neither symplectic nor of their order."},
    {.name = "arkode_erk7",
     .reason = "ARKODE has explicit tables of orders 2 to 6 and 8; asked for 7 it takes 8, which is `arkode_erk8`."},
};

}  // namespace

std::span<const MethodLeftOut> methods_left_out() { return left_out; }

}  // namespace polhode
