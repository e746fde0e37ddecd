#include "integrators/truth/balls/matrix.h"

#include <arb_mat.h>

namespace polhode::truth {

std::vector<Ball> product(const std::vector<Ball>& a, const std::vector<Ball>& b, std::size_t n) {
    std::vector<Ball> c(n * n);
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t k = 0; k < n; ++k) {
            const Ball& factor = a[i * n + k];
            if (factor.is_zero()) continue;
            for (std::size_t j = 0; j < n; ++j)
                if (!b[k * n + j].is_zero()) c[i * n + j] += factor * b[k * n + j];
        }
    return c;
}

std::vector<Ball> inverse_of(const std::vector<double>& matrix, std::size_t n, long bits) {
    const auto size = static_cast<slong>(n);
    arb_mat_t exact, inverse;
    arb_mat_init(exact, size, size);
    arb_mat_init(inverse, size, size);
    for (slong i = 0; i < size; ++i)
        for (slong j = 0; j < size; ++j) arb_set_d(arb_mat_entry(exact, i, j), matrix[i * n + j]);
    if (!arb_mat_inv(inverse, exact, bits)) arb_mat_indeterminate(inverse);
    std::vector<Ball> result(n * n);
    for (slong i = 0; i < size; ++i)
        for (slong j = 0; j < size; ++j) arb_set(result[i * n + j].raw(), arb_mat_entry(inverse, i, j));
    arb_mat_clear(exact);
    arb_mat_clear(inverse);
    return result;
}

}  // namespace polhode::truth
