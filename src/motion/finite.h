// Checks whether numbers are all finite, without a branch per number.
#pragma once

#include <cmath>
#include <span>

#include "body/algebra.h"

namespace polhode {

/// Whether no value is infinite or NaN.
inline bool all_finite(std::span<const double> values) {
    double zeros = 0;
    for (const double value : values) zeros += value * 0;
    return zeros == 0;
}

/// Whether no value is infinite or NaN.
inline bool all_finite(std::span<const float> values) {
    float zeros = 0;
    for (const float value : values) zeros += value * 0;
    return zeros == 0;
}

/// Whether every component of every argument is finite. Forms no squares, which could overflow.
template <class S, class... More>
bool all_finite(const Vector3<S>& v, const More&... more) {
    bool finite = all_finite(std::span<const S>(v.component));
    if constexpr (sizeof...(more) > 0) finite = finite && all_finite(more...);
    return finite;
}
/// Whether every entry is finite.
template <class S>
bool all_finite(const Matrix3<S>& A) {
    return all_finite(A[0], A[1], A[2]);
}
/// Whether all four numbers are finite.
template <class S>
bool all_finite(const Quaternion<S>& q) {
    return all_finite(Vector3<S>(q.x, q.y, q.z)) && std::isfinite(q.w);
}

}  // namespace polhode
