// Formats of tables and figures, in addition to CSV.
#pragma once

#include <array>
#include <string>
#include <string_view>

namespace polhode {

/// Output formats: Markdown, JSON and LaTeX for tables, SVG and PDF for figures. CSV is always written.
struct Formats {
    static constexpr std::array<std::string_view, 5> names{"md", "json", "tex", "svg", "pdf"};

    std::array<bool, names.size()> wanted{true, true, true, true, true};

    bool has(std::string_view name) const;
    /// The names of the selected formats, joined by commas.
    std::string text() const;
};

/// Whether the directory has a table of this experiment in each selected table format.
bool has_table_formats(const std::string& directory, const std::string& experiment, const Formats& formats);

/// Parses a list such as "md,svg"; accepts "csv" too. Throws std::invalid_argument if a name is unknown.
Formats parse_formats(std::string_view text);

}  // namespace polhode
