// A scene that is built in code, and its motion in closed form.
//
// A free symmetric body, I = diag(A, A, C): the angular momentum L is constant and w_B = L_B / A - n e_z with
// n = (C - A) w_z / A, so that q(t) = exp(L t / A) q(0) exp(-n t e_z) (Landau & Lifshitz, Mechanics, section 33).
#pragma once

#include <polhode/polhode.h>

/// Moments A and C (kg m^2) and duration of the motion (s).
constexpr double moment_A = 2, moment_C = 3, duration = 10;

/// The free symmetric body. It starts with the identity attitude, at (0.5, 0, 1) rad/s.
polhode::Scene symmetric_body();

/// Its attitude at time t (s).
polhode::Quaternion<double> symmetric_attitude(double t);

/// The rotation by an angle (rad) about an axis of any nonzero length.
polhode::Quaternion<double> rotation(const polhode::Vector3<double>& axis, double angle);

/// The angle (rad) of the rotation from one attitude to the other.
double angle_between(const polhode::Quaternion<double>& a, const polhode::Quaternion<double>& b);

/// The largest angle (rad), over all samples, between a trajectory of symmetric_body() and the closed form.
double worst_attitude_error(const polhode::Trajectory& trajectory);
