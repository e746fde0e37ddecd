"""Solves the two motions with the Taylor method of heyoka.py. Not run here: Debian has no package of heyoka.py."""

import heyoka as hy
import numpy as np

w1, w2, w3, qw, qx, qy, qz = hy.make_vars("w1", "w2", "w3", "qw", "qx", "qy", "qz")


def equations(moments: tuple[float, float, float], weight: float) -> list[tuple[hy.expression, hy.expression]]:
    """Returns Euler's equations in body axes for the moments about the pivot. `weight` is m g l."""
    I1, I2, I3 = moments
    up1, up2 = 2 * (qx * qz - qw * qy), 2 * (qy * qz + qw * qx)  # the vertical in body axes
    return [
        (w1, ((I2 - I3) * w2 * w3 + weight * up2) / I1),
        (w2, ((I3 - I1) * w3 * w1 - weight * up1) / I2),
        (w3, (I1 - I2) / I3 * w1 * w2),
        (qw, -0.5 * (qx * w1 + qy * w2 + qz * w3)),
        (qx, 0.5 * (qw * w1 + qy * w3 - qz * w2)),
        (qy, 0.5 * (qw * w2 + qz * w1 - qx * w3)),
        (qz, 0.5 * (qw * w3 + qx * w2 - qy * w1)),
    ]


free = hy.taylor_adaptive(equations((1.0, 2.0, 3.0), 0.0), [1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0], tol=1e-12)
free.propagate_until(100.0)
print(free.state[3:])

tilt = [0.9689124217106447, 0.24740395925452294, 0.0, 0.0]
top = hy.taylor_adaptive(equations((1.0, 1.0, 0.5), 5.0), [0.0, 0.0, 20.0, *tilt], tol=1e-12)
samples = top.propagate_grid(np.linspace(0.0, 20.0, 101))[-1]
print(samples[-1, 3:])
