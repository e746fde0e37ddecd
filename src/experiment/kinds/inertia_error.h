// Error and computing time of inertia tensors.
#pragma once

#include <chrono>

#include "body/wide.h"

namespace polhode {

/// Frobenius norm of the difference divided by that of the true tensor, computed in 128 bits.
inline double relative_error(const Matrix3<double>& inertia, const Matrix3<Wide>& truth) {
    Wide difference = 0, size = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const Wide d = Wide(inertia[i][j]) - truth[i][j];
            difference += d * d, size += truth[i][j] * truth[i][j];
        }
    return double(square_root(difference / size));
}

/// Seconds per call of work(). Repeats the call within one timing until it lasts 20 microseconds.
template <class Work>
double measure_seconds(const Work& work) {
    using Clock = std::chrono::steady_clock;
    for (long repeats = 1;; repeats *= 4) {
        const auto start = Clock::now();
        for (long i = 0; i < repeats; ++i) work();
        const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
        if (seconds > 2e-5) return seconds / static_cast<double>(repeats);
    }
}

}  // namespace polhode
