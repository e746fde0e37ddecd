// Methods that were considered and omitted, with reasons.
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
    {.name = "no_squish",
     .reason =
         "The rotations of Miller et al. (2002, J. Chem. Phys. 116, 8649), of a quaternion and its conjugate momentum, "
         "are those of `splitting2` in other variables. Started together in double precision (I = (1, 2, 3), w = (1, "
         "1, 1), h = 1/100) the two differ by 4e-18 after one step, 1e-15 after a hundred, 7e-10 rad after 10^6: by "
         "rounding alone. What differs is the drift of what should stay: over those 10^6 steps L_W moves by 2e-13 of "
         "itself and |q| by 8e-14, where `splitting2` holds L_W to the last bit and |q| to 1e-16."},
    {.name = "arkode_erk7",
     .reason = "ARKODE has explicit tables of orders 2 to 6 and 8; asked for 7 it takes 8, which is `arkode_erk8`."},
    {.name = "euler_angles_float32",
     .reason =
         "Angles are taken from a quaternion and made into one by conversions of binary64, and near gimbal lock, which "
         "this method is here to meet, it fails by its chart long before its arithmetic shows. "
         "`rotation_vector_float32` is a chart in binary32."},
    {.name = "impact_stepping_float32",
     .reason = "Gaps, the times of impacts and the impulses are found in binary64: with steps alone in binary32, "
               "`impact_stepping` would show neither the one arithmetic nor the other."},
    {.name = "odeint_fehlberg78_float32",
     .reason = "Where the errors of orders above 4 differ from those of order 4, at some 1e-6 rad and less, binary32's "
               "rounding hides both. The fixed-step methods up to order 4 are here as `NAME_float32`."},
    {.name = "stiff_extrapolation",
     .reason =
         "The semi-implicit midpoint rule and the linearly implicit Euler method, extrapolated (Bader & Deuflhard "
         "1983; "
         "Deuflhard 1983), with the exact Jacobian and a fixed-size factorisation, by tolerance: measured against "
         "`radau` they lost at every accuracy. On `stiff_drag` the former needs 24 microseconds to 6e-7 rad, 81 to "
         "1e-11 and 130 to 3e-14, the latter 103 to 2e-10, where `radau` needs 15 to 3e-9, 21 to 7e-13 and 27 to "
         "6e-15; on a damped oscillation (spring 10^4, drag 10) 1006 to 1.4e-8 against 197. Their stages come one "
         "after "
         "the other and each column has a factorisation of its own; those of a Radau formula stand side by side."},
};

}  // namespace

std::span<const MethodLeftOut> methods_left_out() { return left_out; }

}  // namespace polhode
