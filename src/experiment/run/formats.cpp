#include "experiment/run/formats.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "text/message.h"

namespace polhode {

bool Formats::has(std::string_view name) const {
    const auto found = std::ranges::find(names, name);
    return found != names.end() && wanted[static_cast<std::size_t>(found - names.begin())];
}

std::string Formats::text() const {
    std::string list;
    for (const std::string_view name : names)
        if (has(name)) list.append(list.empty() ? "" : ",").append(name);
    return list;
}

Formats parse_formats(std::string_view text) {
    Formats formats;
    formats.wanted.fill(false);
    while (!text.empty()) {
        const std::string_view word = text.substr(0, text.find(','));
        text.remove_prefix(std::min(text.size(), word.size() + 1));
        const auto found = std::ranges::find(Formats::names, word);
        if (found != Formats::names.end())
            formats.wanted[static_cast<std::size_t>(found - Formats::names.begin())] = true;
        else if (word != "csv")
            throw std::invalid_argument(fmt::format("there is no format {}; give some of csv, {}",
                                                    one_line(std::string(word), 50), fmt::join(Formats::names, ", ")));
    }
    return formats;
}

}  // namespace polhode
