// In which formats an experiment's tables and pictures are written beside the CSV files.
#pragma once

#include <array>
#include <string>
#include <string_view>

namespace polhode {

/// The formats beside CSV, which is always written: tables as Markdown, JSON and LaTeX, pictures as SVG and PDF.
struct Formats {
    static constexpr std::array<std::string_view, 5> names{"md", "json", "tex", "svg", "pdf"};

    std::array<bool, names.size()> wanted{true, true, true, true, true};

    bool has(std::string_view name) const;
    /// The names of those wanted, with commas between.
    std::string text() const;
};

/// Whether the directory has a table of this experiment in each of the table formats wanted.
bool has_table_formats(const std::string& directory, const std::string& experiment, const Formats& formats);

/// Reads a list such as "md,svg"; "csv" may stand in it. Throws std::invalid_argument on any other word.
Formats parse_formats(std::string_view text);

}  // namespace polhode
