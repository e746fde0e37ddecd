"""Solves the two motions with polhode: errors against the truth, and the final state to forty proven digits."""

import polhode

free = {"duration": 100, "body": {"mass": 1, "inertia": [1, 2, 3]}, "initial": {"angular_velocity": [1, 1, 1]}}
top = {
    "duration": 20, "pivot": [0, 0, 0],
    "body": {"mass": 1, "inertia": [0.75, 0.75, 0.5], "center_of_mass": [0, 0, 0.5]},
    "initial": {"orientation": [0.9689124217106447, 0.24740395925452294, 0, 0], "angular_velocity": [0, 0, 20]},
    "loads": [{"type": "gravity", "acceleration": [0, 0, -10]}],
}  # fmt: skip
print(f"{'scene':16} {'tolerance':>9} {'evaluations':>12} {'seconds':>8} {'attitude error (rad)':>21}")
for name, scene in (("free_asymmetric", free), ("lagrange_top", top)):
    for method, tolerance in (("dop853", 1e-6), ("dop853", 1e-9), ("dop853", 1e-12), ("auto", None)):
        motion = polhode.solve(scene, method, tolerance=tolerance, samples=1)
        error, told = motion.errors().final["attitude"], motion.method if tolerance is None else f"{tolerance:.0e}"
        print(f"{name:16} {told:>9} {motion.rhs_evaluations:12} {motion.seconds:8.1e} {error:21.1e}")
    proven = polhode.truth(scene, samples=1, digits=40, certified=True)
    print(f"{name:16} proven: qw = {proven.decimals['qw'][1]} +- {proven.radii['qw'][1]}")
