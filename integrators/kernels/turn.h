// Attitudes that are turned many times over: small turns as what they differ from the identity by, and sums that keep
// what rounding takes from them.
//
// A step turns q by a little, q <- q (1 + d). Written so, the product's rounding is relative to d; added with
// compensation the attitude's error grows as that of the increments does, at random, and a bias of sine and cosine
// (cos^2 + sin^2 is 1 to rounding only, by the same amount at every step of the same angle) stays one of d. The length
// of q, which nothing else holds, is led back to 1 with each turn.
#pragma once

#include <cmath>

#include "body/algebra.h"

namespace polhode {

/// The unit quaternion (1 + w, v).
struct Turn {
    double w = 0;
    Vector3<double> v;
};

/// First a, then b, about the axes that a has turned: (1 + a)(1 + b) - 1.
inline Turn then(const Turn& a, const Turn& b) {
    return {a.w + b.w + (a.w * b.w - dot(a.v, b.v)), a.v + b.v + (a.w * b.v + b.w * a.v + cross(a.v, b.v))};
}

/// cos x - 1 and sin x / x, each to a few ulp, as functions of x^2.
struct SineCosine {
    double cosine_less_one, sine_by_angle;

    explicit SineCosine(double square) {
        if (square < 0.25) {
            // Taylor's series, even and odd powers of the square apart
            const double s = square, u = s * s;
            cosine_less_one = s * ((-1.0 / 2 + u * (-1.0 / 720 + u * (-1.0 / 3628800 + u * (-1.0 / 87178291200)))) +
                                   s * (1.0 / 24 + u * (1.0 / 40320 + u * (1.0 / 479001600))));
            sine_by_angle = (1 + u * (1.0 / 120 + u * (1.0 / 362880 + u * (1.0 / 6227020800)))) -
                            s * (1.0 / 6 + u * (1.0 / 5040 + u * (1.0 / 39916800 + u * (1.0 / 1307674368000))));
            return;
        }
        const double x = std::sqrt(square), half = std::sin(x / 2);
        cosine_less_one = -2 * half * half;
        sine_by_angle = std::sin(x) / x;
    }
};

/// A turn by |v| rad about v.
inline Turn turn_by(const Vector3<double>& v) {
    const Vector3<double> half = 0.5 * v;
    const SineCosine f(dot(half, half));
    return {f.cosine_less_one, f.sine_by_angle * half};
}

/// A sum of many small terms, with what rounding took from it (W. Kahan 1965, Commun. ACM 8, 40; the rounding error
/// by D. E. Knuth's branch-free TwoSum).
struct CompensatedSum {
    double value = 0, lost = 0;

    void add(double term) {
        const double wanted = term + lost, sum = value + wanted, part = sum - value;
        lost = (value - (sum - part)) + (wanted - part);
        value = sum;
    }
};

class CompensatedVector {
  public:
    CompensatedVector() = default;
    explicit CompensatedVector(const Vector3<double>& v) : sum_{{v[0], 0}, {v[1], 0}, {v[2], 0}} {}

    void add(const Vector3<double>& v) {
        for (int i = 0; i < 3; ++i) sum_[i].add(v[i]);
    }
    Vector3<double> value() const { return {sum_[0].value, sum_[1].value, sum_[2].value}; }

  private:
    CompensatedSum sum_[3];
};

/// A unit quaternion that is turned many times.
class TurnedAttitude {
  public:
    TurnedAttitude() : TurnedAttitude(Quaternion<double>{}) {}
    explicit TurnedAttitude(const Quaternion<double>& q) : w_{q.w, 0}, x_{q.x, 0}, y_{q.y, 0}, z_{q.z, 0} {}

    Quaternion<double> value() const { return {w_.value, x_.value, y_.value, z_.value}; }

    /// q <- q (1 + d), d about the body's axes; and q <- q (3 - |q|^2) / 2, which leads the length to 1.
    void turn(const Turn& d) {
        const Quaternion<double> q = value();
        const double w = d.w + (1 - squared_norm(q)) / 2;
        const Quaternion<double> change = q * Quaternion<double>{w, d.v[0], d.v[1], d.v[2]};
        w_.add(change.w), x_.add(change.x), y_.add(change.y), z_.add(change.z);
    }

  private:
    CompensatedSum w_, x_, y_, z_;
};

}  // namespace polhode
