"""Solves a body with a user-defined load: equations by SymPy, generated code, SciPy's solve_ivp."""

import time

import numpy as np
import sympy
from scipy.integrate import solve_ivp

t, *y = sympy.symbols("t w1 w2 w3 qw qx qy qz")
w, v, qw = sympy.Matrix(y[:3]), sympy.Matrix(y[4:]), y[3]
inertia = sympy.diag(1, 2, 3)


def to_body(a: sympy.Matrix) -> sympy.Matrix:
    """Returns a vector in world axes, converted to body axes."""
    return a + 2 * v.cross(v.cross(a)) - 2 * qw * v.cross(a)


drive = sympy.Matrix([3 * sympy.sin(t), 3 * sympy.cos(t), 0]) / 10
torque = -sympy.Rational(1, 20) * w * sympy.sqrt(w.dot(w)) + to_body(drive)
rates = [*(inertia.inv() * (torque - w.cross(inertia * w))), -v.dot(w) / 2, *(qw * w + v.cross(w)) / 2]
begin = time.perf_counter()
derivative = sympy.lambdify([t, *y], rates, cse=True)
print(f"code generated in {1e3 * (time.perf_counter() - begin):.1f} ms")

# q at t = 20 s by `polhode truth`
truth = np.array([-0.172259081125302463334, -0.0177907787015770404054, -0.100503373150064168679, -0.979749646158913873235])
print(f"{'rtol':>6} {'evaluations':>12} {'seconds':>8} {'attitude error (rad)':>21}")
for rtol in (1e-6, 1e-9, 1e-12):
    begin = time.perf_counter()
    motion = solve_ivp(lambda t, y: derivative(t, *y), (0, 20), [1, 1, 1, 1, 0, 0, 0], method="DOP853", rtol=rtol, atol=rtol)
    seconds = time.perf_counter() - begin
    q = motion.y[3:, -1]
    vector = truth[0] * q[1:] - q[0] * truth[1:] - np.cross(truth[1:], q[1:])
    error = 2 * np.arctan2(np.linalg.norm(vector), abs(truth @ q))
    print(f"{rtol:6.0e} {motion.nfev:12} {seconds:8.1e} {error:21.1e}")
