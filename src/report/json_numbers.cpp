#include "report/json_numbers.h"

#include <algorithm>
#include <charconv>

namespace polhode {

Json number_json(double value, int digits) {
    if (!std::isfinite(value)) return nullptr;
    // the binary64 nearest to the rounded decimal, which is written as that decimal
    char buffer[40];
    const auto written =
        std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::scientific, digits - 1);
    double rounded = value;
    std::from_chars(buffer, written.ptr, rounded);
    if (rounded == std::trunc(rounded) && std::abs(rounded) < 1e15) return static_cast<long>(rounded);
    return rounded;
}

Json numbers_json(const std::vector<double>& values, int digits) {
    Json list = Json::array();
    for (const double value : values) list.push_back(number_json(value, digits));
    return list;
}

std::vector<std::size_t> spread_indices(std::size_t count, std::size_t most) {
    std::vector<std::size_t> places;
    const std::size_t shown = std::min(count, most);
    for (std::size_t i = 0; i < shown; ++i) places.push_back(shown > 1 ? i * (count - 1) / (shown - 1) : 0);
    return places;
}

Json vector_json(const Vector3<double>& v) {
    return {number_json(v[0], 6), number_json(v[1], 6), number_json(v[2], 6)};
}

Json quaternion_json(const Quaternion<double>& q) {
    return {number_json(q.w, 8), number_json(q.x, 8), number_json(q.y, 8), number_json(q.z, 8)};
}

}  // namespace polhode
