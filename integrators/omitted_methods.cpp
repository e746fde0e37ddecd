// Methods that were considered and omitted, with reasons.
#include "integrators/method.h"

namespace polhode {
namespace {

constexpr OmittedMethod omitted[] = {
    {.name = "odeint_symplectic",
     .reason =
         "Odeint's symplectic steppers (`symplectic_euler`, `symplectic_rkn_sb3a_mclachlan`, "
         "`symplectic_rkn_sb3a_m4_mclachlan`) and its `velocity_verlet` integrate dq/dt = f(p), dp/dt = g(q). A rigid "
         "body's motion does not have this form. In canonical coordinates of the attitude, the kinetic energy depends "
         "on both coordinates and momenta. In Euler's equations, dL/dt = L x I^-1 L, the rate of the momenta depends "
         "on the momenta. Applied to (q, w), the steppers would be neither symplectic nor of their order."},
    {.name = "no_squish",
     .reason =
         "The rotations of Miller et al. (2002, J. Chem. Phys. 116, 8649), of a quaternion and its conjugate momentum, "
         "are those of `splitting2` in other variables. Started together in double precision (I = (1, 2, 3), w = (1, "
         "1, 1), h = 1/100) the two differ by 4e-18 after one step, 1e-15 after a hundred and 7e-10 rad after 10^6, "
         "which is rounding only. They differ in the drift of invariants: over those 10^6 steps the relative change of "
         "L_W is 2e-13 and that of |q| 8e-14, whereas `splitting2` keeps L_W to the last bit and |q| to 1e-16."},
    {.name = "arkode_erk7",
     .reason = "ARKODE has explicit tables of orders 2 to 6 and 8. For order 7 it uses the table of order 8, which is "
               "`arkode_erk8`."},
    {.name = "euler_angles_float32",
     .reason =
         "The conversions between angles and quaternions use binary64. Near gimbal lock, which this method is meant to "
         "show, the chart fails long before the arithmetic matters. `rotation_vector_float32` is a chart in binary32."},
    {.name = "impact_stepping_float32",
     .reason = "Gaps, impact times and impulses are computed in binary64. With only the steps in binary32, "
               "`impact_stepping` would represent neither arithmetic."},
    {.name = "odeint_fehlberg78_float32",
     .reason = "Orders above 4 differ from order 4 only at errors of about 1e-6 rad and less, which the rounding of "
               "binary32 hides. The fixed-step methods up to order 4 are available as `NAME_float32`."},
    {.name = "stiff_extrapolation",
     .reason =
         "The semi-implicit midpoint rule and the linearly implicit Euler method, extrapolated (Bader & Deuflhard "
         "1983; Deuflhard 1983), with the exact Jacobian and a fixed-size factorisation, by tolerance, were slower "
         "than `radau` at every accuracy. On `stiff_drag` the midpoint rule takes 24 microseconds to reach 6e-7 rad, "
         "81 to 1e-11 and 130 to 3e-14, and the Euler method 103 to 2e-10, whereas `radau` takes 15 to 3e-9, 21 to "
         "7e-13 and 27 to 6e-15. On a damped oscillation (spring 10^4, drag 10) it is 1006 to 1.4e-8 against 197. "
         "Their stages are sequential and each column needs its own factorisation; the stages of a Radau formula are "
         "computed side by side."},
};

}  // namespace

std::span<const OmittedMethod> omitted_methods() { return omitted; }

}  // namespace polhode
