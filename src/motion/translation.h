// The motion of a centre of mass under a constant acceleration and linear drag, in closed form.
#pragma once

#include "body/algebra.h"

namespace polhode {

/// Moves p (m) and v (m/s) on by a time t (s) under dv/dt = a - k v, a in m/s^2, k >= 0 or < 0 in 1/s:
///   v = v0 e^-kt + a (1 - e^-kt)/k,  p = p0 + v0 (1 - e^-kt)/k + a (kt - 1 + e^-kt)/k^2.
void translate(const Vector3<double>& a, double k, double t, Vector3<double>& p, Vector3<double>& v);

}  // namespace polhode
