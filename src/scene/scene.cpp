#include "scene/scene.h"

namespace polhode {

Window window_of(const Load& load) {
    return std::visit(
        [](const auto& one) {
            if constexpr (requires { one.window; })
                return one.window;
            else
                return Window{};
        },
        load);
}

std::string load_body(const Load& load) {
    return std::visit(
        [](const auto& one) {
            if constexpr (requires { one.body; })
                return one.body;
            else
                return std::string();
        },
        load);
}

}  // namespace polhode
