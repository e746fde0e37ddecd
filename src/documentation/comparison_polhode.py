"""The same two motions by polhode, each error against the truth."""

import polhode

print(f"{'scene':16} {'method':14} {'tol':>6} {'evaluations':>12} {'seconds':>8} {'attitude error (rad)':>21}")
for scene in "free_asymmetric", "lagrange_top":
    for method in "dop853", "extrapolation", "exact":
        for tolerance in (None,) if method == "exact" else (1e-6, 1e-9, 1e-12):
            motion = polhode.solve(scene, method, tolerance=tolerance, samples=1)
            error = motion.errors().final["attitude"]
            told = "" if tolerance is None else f"{tolerance:.0e}"
            print(f"{scene:16} {method:14} {told:>6} {motion.rhs_evaluations:12} {motion.seconds:8.1e} {error:21.1e}")
