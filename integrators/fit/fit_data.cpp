// Reads measured motion.
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "integrators/fit/fit.h"
#include "text/csv_lines.h"
#include "text/decimal.h"
#include "text/message.h"

namespace polhode {
namespace {

constexpr struct {
    std::string_view first, axes, suffix;
    FitQuantity quantity;
} fit_blocks[] = {{"q", "wxyz", "", FitQuantity::attitude},
                  {"w", "xyz", "", FitQuantity::angular_velocity_W},
                  {"w", "xyz", "_B", FitQuantity::angular_velocity_B},
                  {"p", "xyz", "", FitQuantity::position_W},
                  {"v", "xyz", "", FitQuantity::velocity_W}};

bool find_quantity(std::string_view name, FitColumn& column) {
    for (const auto& block : fit_blocks)
        for (std::size_t k = 0; k < block.axes.size(); ++k)
            if (name == fmt::format("{}{}{}", block.first, block.axes[k], block.suffix)) {
                column.quantity = block.quantity, column.component = k;
                return true;
            }
    return false;
}

std::string known_fit_columns() {
    std::vector<std::string> names;
    for (const auto& block : fit_blocks)
        for (const char axis : block.axes) names.push_back(fmt::format("{}{}{}", block.first, axis, block.suffix));
    return fmt::format("{}", fmt::join(names, ", "));
}

// The columns of a header that are read: the place of t and of each column of the data.
struct FitHeader {
    std::size_t time = 0;
    std::vector<std::size_t> places;
};

FitHeader read_fit_header(const CsvLines& lines, const std::string& file, const std::vector<std::string>& bodies,
                          const std::vector<std::string>& wanted, FitData& data) {
    const std::vector<std::string_view>& cells = lines.cells();
    const std::string place = fmt::format("line {}", lines.number());
    const auto place_of = [&](std::string_view name) {
        const auto found = std::find(cells.begin(), cells.end(), name);
        if (found == cells.end())
            throw InputError(
                file, place, fmt::format("has no column {}", one_line(name, 60)),
                fmt::format("the columns are {}", one_line(fmt::format("{}", fmt::join(cells, ", ")), 200)));
        if (std::find(found + 1, cells.end(), name) != cells.end())
            throw InputError(file, place, fmt::format("has two columns {}", one_line(name, 60)), "remove one");
        return static_cast<std::size_t>(found - cells.begin());
    };
    FitHeader header;
    header.time = place_of("t");
    std::vector<std::string> names = wanted;
    if (names.empty())
        for (const std::string_view cell : cells) {
            try {
                fit_column(cell, bodies);
                names.emplace_back(cell);
            } catch (const std::invalid_argument&) {
                // a column of another quantity
            }
        }
    if (names.empty())
        throw InputError(file, place, "has no column of the motion",
                         "the columns are " + known_fit_columns() +
                             (bodies.size() > 1 ? ", each after the name of a body and a point" : ""));
    for (const std::string& name : names) {
        data.columns.push_back(fit_column(name, bodies));
        header.places.push_back(place_of(name));
    }
    return header;
}

}  // namespace

FitColumn fit_column(std::string_view name, const std::vector<std::string>& bodies) {
    FitColumn column;
    column.name = name;
    std::string_view quantity = name;
    const std::size_t point = name.rfind('.');
    const bool several = bodies.size() > 1;
    bool known = several == (point != name.npos);
    if (known && several) {
        quantity = name.substr(point + 1);
        const auto body = std::find(bodies.begin(), bodies.end(), name.substr(0, point));
        known = body != bodies.end();
        column.body = static_cast<std::size_t>(body - bodies.begin());
    }
    if (!known || !find_quantity(quantity, column))
        throw std::invalid_argument(
            fmt::format("there is no column {}; the columns are {}{}", one_line(name, 60), known_fit_columns(),
                        several ? fmt::format(", after the name of a body: {}.px", one_line(bodies.front(), 60)) : ""));
    return column;
}

FitData parse_fit_data(std::string_view text, const std::string& file, const std::vector<std::string>& bodies,
                       const std::vector<std::string>& columns) {
    CsvLines lines(text, file);
    if (!lines.next()) throw InputError(file, "", "is empty", "give a header and one line per time");
    FitData data;
    const FitHeader header = read_fit_header(lines, file, bodies, columns, data);
    const std::vector<std::string> names(lines.cells().begin(), lines.cells().end());
    const auto number = [&](std::size_t place) {
        const std::string_view cell = lines.cells()[place];
        const std::optional<double> value = parse_decimal(cell);
        if (!value)
            throw InputError(file, fmt::format("line {}, column {}", lines.number(), one_line(names[place], 60)),
                             fmt::format("\"{}\" is not a finite number", one_line(cell, 40)), "give a number");
        return *value;
    };
    while (lines.next()) {
        const std::string place = fmt::format("line {}", lines.number());
        if (lines.cells().size() != names.size())
            throw InputError(file, place, fmt::format("has {} cells", lines.cells().size()),
                             fmt::format("give {}, as in the header", names.size()));
        const double t = number(header.time);
        if (t < 0 || (!data.times.empty() && t <= data.times.back()))
            throw InputError(file, place + ", column t", "is not later than the line before", "sort the lines by time");
        data.times.push_back(t);
        for (const std::size_t column : header.places) data.values.push_back(number(column));
    }
    if (data.times.empty()) throw InputError(file, "", "has no line after the header", "give one line per time");
    return data;
}

}  // namespace polhode
