// Attitudes that are updated by many rotations: small rotations stored as their difference from the identity, and
// compensated sums.
//
// A step updates q <- q (1 + d) with a small d. In this form the rounding error of the product is relative to d. With
// compensated addition the attitude error grows only as fast as that of the increments, at random. Biases of sine and
// cosine (cos^2 + sin^2 is 1 only to rounding, with the same deviation at every step of the same angle) remain
// relative to d. Each update also corrects |q| towards 1, which nothing else controls.
//
// S: double or float. Names without `Of` are for double.
#pragma once

#include <cmath>

#include "body/algebra.h"

namespace polhode {

/// Unit quaternion (1 + w, v).
template <class S>
struct RotationIncrementOf {
    S w = 0;
    Vector3<S> v;
};
using RotationIncrement = RotationIncrementOf<double>;

/// Rotation a, then b about the axes rotated by a: (1 + a)(1 + b) - 1.
template <class S>
RotationIncrementOf<S> compose(const RotationIncrementOf<S>& a, const RotationIncrementOf<S>& b) {
    return {a.w + b.w + (a.w * b.w - dot(a.v, b.v)), a.v + b.v + (a.w * b.v + b.w * a.v + cross(a.v, b.v))};
}

/// cos x - 1 and sin x / x as functions of x^2, each to a few ulp.
template <class S>
struct SineCosine {
    S cosine_less_one, sine_by_angle;

    explicit SineCosine(S square) {
        if (square < S(0.25)) {
            // Taylor series, with even and odd powers of the square separated.
            const S s = square, u = s * s;
            const auto part = [](double divisor) { return S(1 / divisor); };
            cosine_less_one = s * ((part(-2) + u * (part(-720) + u * (part(-3628800) + u * part(-87178291200)))) +
                                   s * (part(24) + u * (part(40320) + u * part(479001600))));
            sine_by_angle = (1 + u * (part(120) + u * (part(362880) + u * part(6227020800)))) -
                            s * (part(6) + u * (part(5040) + u * (part(39916800) + u * part(1307674368000))));
            return;
        }
        const S x = std::sqrt(square), half = std::sin(x / 2);
        cosine_less_one = -2 * half * half;
        sine_by_angle = std::sin(x) / x;
    }
};

/// Rotation by |v| rad about v.
template <class S>
RotationIncrementOf<S> rotation_increment(const Vector3<S>& v) {
    const Vector3<S> half = S(0.5) * v;
    const SineCosine f(dot(half, half));
    return {f.cosine_less_one, f.sine_by_angle * half};
}

/// A sum of many small terms with its rounding error (W. Kahan 1965, Commun. ACM 8, 40; rounding error by D. E.
/// Knuth's branch-free TwoSum).
template <class S>
struct CompensatedSumOf {
    S value = 0, lost = 0;

    void add(S term) {
        const S wanted = term + lost, sum = value + wanted, part = sum - value;
        lost = (value - (sum - part)) + (wanted - part);
        value = sum;
    }
};

using CompensatedSum = CompensatedSumOf<double>;

/// A vector of compensated sums.
template <class S>
class CompensatedVectorOf {
  public:
    CompensatedVectorOf() = default;
    explicit CompensatedVectorOf(const Vector3<S>& v) : sum_{{v[0], 0}, {v[1], 0}, {v[2], 0}} {}

    void add(const Vector3<S>& v) {
        for (int i = 0; i < 3; ++i) sum_[i].add(v[i]);
    }
    Vector3<S> value() const { return {sum_[0].value, sum_[1].value, sum_[2].value}; }

  private:
    CompensatedSumOf<S> sum_[3];
};
using CompensatedVector = CompensatedVectorOf<double>;

/// A unit quaternion that is updated by many rotations.
template <class S>
class CompensatedAttitudeOf {
  public:
    CompensatedAttitudeOf() : CompensatedAttitudeOf(Quaternion<S>{}) {}
    explicit CompensatedAttitudeOf(const Quaternion<S>& q) : w_{q.w, 0}, x_{q.x, 0}, y_{q.y, 0}, z_{q.z, 0} {}

    Quaternion<S> value() const { return {w_.value, x_.value, y_.value, z_.value}; }

    /// q <- q (1 + d), with d about body axes, and q <- q (3 - |q|^2) / 2, which corrects the norm towards 1.
    void rotate(const RotationIncrementOf<S>& d) {
        const Quaternion<S> q = value();
        const S w = d.w + (1 - squared_norm(q)) / 2;
        const Quaternion<S> change = q * Quaternion<S>{w, d.v[0], d.v[1], d.v[2]};
        w_.add(change.w), x_.add(change.x), y_.add(change.y), z_.add(change.z);
    }

  private:
    CompensatedSumOf<S> w_, x_, y_, z_;
};
using CompensatedAttitude = CompensatedAttitudeOf<double>;

}  // namespace polhode
