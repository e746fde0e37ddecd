"""Solves the body with the user-defined load with heyoka.py. Not run here: Debian has no package of heyoka.py."""

import heyoka as hy
import numpy as np

w1, w2, w3, qw, qx, qy, qz = hy.make_vars("w1", "w2", "w3", "qw", "qx", "qy", "qz")
w, v = np.array([w1, w2, w3]), np.array([qx, qy, qz])
drive = np.array([0.3 * hy.sin(hy.time), 0.3 * hy.cos(hy.time), hy.expression(0.0)])
to_body = drive + 2.0 * np.cross(v, np.cross(v, drive)) - 2.0 * qw * np.cross(v, drive)
moments = np.array([1.0, 2.0, 3.0])
torque = -0.05 * w * hy.sqrt(w1 * w1 + w2 * w2 + w3 * w3) + to_body
w_rate = (torque - np.cross(w, moments * w)) / moments
v_rate = 0.5 * (qw * w + np.cross(v, w))
system = [(w1, w_rate[0]), (w2, w_rate[1]), (w3, w_rate[2]), (qw, -0.5 * (qx * w1 + qy * w2 + qz * w3)),
          (qx, v_rate[0]), (qy, v_rate[1]), (qz, v_rate[2])]  # fmt: skip
body = hy.taylor_adaptive(system, [1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0], tol=1e-12)
body.propagate_until(20.0)
print(body.state[3:])
