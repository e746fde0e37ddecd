// Closed-form motion of a centre of mass under constant acceleration and linear drag.
#pragma once

#include "body/algebra.h"

namespace polhode {

/// Advances p (m) and v (m/s) by a time t (s) under dv/dt = a - k v, with a in m/s^2 and k of either sign in 1/s:
///   v = v0 e^-kt + a (1 - e^-kt)/k,  p = p0 + v0 (1 - e^-kt)/k + a (kt - 1 + e^-kt)/k^2.
void translate(const Vector3<double>& a, double k, double t, Vector3<double>& p, Vector3<double>& v);

}  // namespace polhode
