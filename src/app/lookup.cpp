#include "app/lookup.h"

#include <fmt/format.h>

#include "app/commands.h"
#include "text/message.h"

namespace polhode {

std::vector<std::string> method_names() {
    std::vector<std::string> names;
    for (const Method* method : methods()) names.emplace_back(method->name);
    return names;
}

const Method& method_named(const std::string& name) {
    if (const Method* method = find_method(name)) return *method;
    for (const MethodLeftOut& method : methods_left_out())
        if (method.name == name)
            throw UsageError(fmt::format("there is no method {0}; polhode describe {0} tells why", name));
    const std::string meant = did_you_mean(name, method_names());
    throw UsageError(
        fmt::format("there is no method {}; {}", name, meant.empty() ? "see polhode list methods" : meant));
}

}  // namespace polhode
