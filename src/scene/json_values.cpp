#include "scene/json_values.h"

#include <fmt/format.h>

#include "text/decimal.h"

namespace polhode {

double positive(const JsonNode& node, const char* what) {
    const double value = node.number();
    if (!(value > 0)) node.fail(node.describe(), fmt::format("{} must be > 0", what));
    return value;
}

std::string write_json(const Vector3<double>& v) {
    return fmt::format("[{}, {}, {}]", shortest_decimal(v[0]), shortest_decimal(v[1]), shortest_decimal(v[2]));
}

std::string write_json(const Quaternion<double>& q) {
    return fmt::format("[{}, {}, {}, {}]", shortest_decimal(q.w), shortest_decimal(q.x), shortest_decimal(q.y),
                       shortest_decimal(q.z));
}

std::string write_json(const std::array<double, 2>& pair) {
    return fmt::format("[{}, {}]", shortest_decimal(pair[0]), shortest_decimal(pair[1]));
}

}  // namespace polhode
