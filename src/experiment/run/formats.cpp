#include "experiment/run/formats.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <stdexcept>
#include <system_error>

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

bool has_table_formats(const std::string& directory, const std::string& experiment, const Formats& formats) {
    return std::ranges::all_of(std::array{"md", "json", "tex"}, [&](const char* format) {
        if (!formats.has(format)) return true;
        std::error_code none;
        const std::filesystem::directory_iterator files(directory, none);
        return std::any_of(begin(files), end(files), [&](const auto& entry) {
            const std::string name = entry.path().filename().string();
            return name.starts_with(experiment) && name.ends_with(std::string(".") + format);
        });
    });
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
            throw std::invalid_argument(fmt::format("{} is an unknown format; give a list of csv, {}",
                                                    one_line(std::string(word), 50), fmt::join(Formats::names, ", ")));
    }
    return formats;
}

}  // namespace polhode
