#include "scene/json_values.h"

#include <fmt/format.h>

namespace polhode {

double positive(const JsonNode& node, const char* what) {
    const double value = node.number();
    if (!(value > 0)) node.fail(node.described(), fmt::format("{} must be > 0", what));
    return value;
}

}  // namespace polhode
