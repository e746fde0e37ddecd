#include "scene/scene.h"

#include "scene/message.h"

namespace polhode {

InputError::InputError(const std::string& file, const std::string& place, const std::string& fault,
                       const std::string& remedy)
    : std::runtime_error(one_line(file, 200) + ": " + (place.empty() ? "" : one_line(place, 300) + ": ") +
                         one_line(fault, 300) + "; " + one_line(remedy, 400)) {}

InputError::InputError(const std::string& file, const std::string& place, const InputError& inner)
    : std::runtime_error(one_line(file, 200) + ": " + one_line(place, 100) + ": " + one_line(inner.what(), 900)) {}

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

}  // namespace polhode
