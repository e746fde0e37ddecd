"""Solves the body with the user-defined load with polhode: a formula, errors against the truth, forty digits."""

import polhode

scene = {
    "duration": 20, "body": {"mass": 1, "inertia": [1, 2, 3]}, "initial": {"angular_velocity": [1, 1, 1]},
    "loads": [{"type": "torque", "frame": "body", "formula": "-0.05*w*norm(w) + to_body([0.3*sin(t), 0.3*cos(t), 0])"}],
}  # fmt: skip
print(f"{'method':13} {'tolerance':>9} {'evaluations':>12} {'seconds':>8} {'attitude error (rad)':>21}")
for method in ("dop853", "taylor", "extrapolation"):
    for tolerance in (1e-6, 1e-9, 1e-12):
        motion = polhode.solve(scene, method, tolerance=tolerance, samples=1)
        error = motion.errors().final["attitude"]
        print(f"{method:13} {tolerance:9.0e} {motion.rhs_evaluations:12} {motion.seconds:8.1e} {error:21.1e}")
print("qw = " + polhode.truth(scene, samples=1, digits=40).decimals["qw"][1])
