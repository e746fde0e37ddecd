// How wrong an inertia tensor is.
#pragma once

#include "body/wide.h"

namespace polhode {

/// Frobenius norm of the difference over that of the true tensor, in 128 bits.
inline double relative_error(const Matrix3<double>& inertia, const Matrix3<Wide>& truth) {
    Wide difference = 0, size = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const Wide d = Wide(inertia[i][j]) - truth[i][j];
            difference += d * d, size += truth[i][j] * truth[i][j];
        }
    return double(square_root(difference / size));
}

}  // namespace polhode
