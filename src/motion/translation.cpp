#include "motion/translation.h"

#include <cmath>

namespace polhode {
namespace {

// (x - 1 + e^-x) / x^2, by its series where the closed form would cancel
double second_decay_integral(double x) {
    if (x > 0.5) return (x + std::expm1(-x)) / (x * x);
    double term = 0.5, sum = 0;
    for (int n = 3; n < 24; ++n) sum += term, term *= -x / n;
    return sum;
}

}  // namespace

void translate(const Vector3<double>& a, double k, double t, Vector3<double>& p, Vector3<double>& v) {
    if (k == 0) {
        p = p + (t * v + (0.5 * (t * t)) * a);
        v = v + t * a;
        return;
    }
    const double decayed = -std::expm1(-k * t) / k;
    const double twice = t * t * second_decay_integral(k * t);
    p = p + (decayed * v + twice * a);
    v = std::exp(-k * t) * v + decayed * a;
}

}  // namespace polhode
