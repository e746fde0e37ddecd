#include "figure/thinned.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace polhode {

void thin(Curve& curve, std::size_t columns) {
    const std::size_t count = std::min(curve.x.size(), curve.y.size());
    if (columns == 0 || count <= 4 * columns) return;
    const double begin = curve.x[0], length = curve.x[count - 1] - begin;
    if (!(length > 0) || !std::isfinite(length)) return;
    const auto column_of = [&](std::size_t i) {
        return std::min(columns - 1,
                        static_cast<std::size_t>((curve.x[i] - begin) / length * static_cast<double>(columns)));
    };
    std::vector<double> x, y;
    for (std::size_t first = 0, end = 0; first < count; first = end) {
        std::size_t lowest = first, highest = first;
        for (end = first; end < count && column_of(end) == column_of(first); ++end) {
            if (curve.y[end] < curve.y[lowest]) lowest = end;
            if (curve.y[end] > curve.y[highest]) highest = end;
        }
        std::array<std::size_t, 4> selected{first, lowest, highest, end - 1};
        std::ranges::sort(selected);
        for (std::size_t k = 0; k < selected.size(); ++k)
            if (k == 0 || selected[k] != selected[k - 1])
                x.push_back(curve.x[selected[k]]), y.push_back(curve.y[selected[k]]);
    }
    curve.x = std::move(x), curve.y = std::move(y);
}

}  // namespace polhode
