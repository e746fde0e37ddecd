#include "check/foreign_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <stdexcept>

#include "text/csv_lines.h"
#include "text/message.h"

namespace polhode {
namespace {

constexpr std::array native_names{"t",  "qw", "qx", "qy", "qz", "wx", "wy", "wz", "px",
                                  "py", "pz", "ox", "oy", "oz", "vx", "vy", "vz", "bound"};

std::string matrix_entry(int i) { return fmt::format("r{}{}", i / 3 + 1, i % 3 + 1); }

// Keeps letters, as lower case, and digits: "Rot.W" and "rot_w" become "rotw".
std::string plain_name(std::string_view name) {
    std::string result;
    for (const char c : name)
        if (std::isalnum(static_cast<unsigned char>(c)))
            result += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return result;
}

// Names that other programs use for a block, as plain names without the component's letter.
struct KnownNames {
    char native;  // polhode's letter for the block
    std::vector<std::string_view> names;
};
const std::vector<KnownNames>& known_names() {
    static const std::vector<KnownNames> all{
        {'q', {"q", "quat", "quaternion", "rot", "rotation", "orientation", "attitude"}},
        {'w', {"w", "omega", "angularvelocity", "angvel", "avel", "av", "gyro"}},
        {'p', {"p", "pos", "position", "com", "translation", ""}},
        {'v', {"v", "vel", "velocity", "linearvelocity", "linvel", "lv"}},
    };
    return all;
}

// Returns polhode's name for a column of another program, if it is known.
std::optional<std::string> recognise(std::string_view name) {
    const std::string plain = plain_name(name);
    for (const char* time : {"t", "time", "times", "timestamp", "seconds", "sec", "simtime"})
        if (plain == time) return "t";
    if (plain.empty()) return {};
    const char component = plain.back();
    const std::string stem = plain.substr(0, plain.size() - 1);
    if (component != 'w' && component != 'x' && component != 'y' && component != 'z') return {};
    for (const KnownNames& block : known_names())
        if (std::ranges::find(block.names, stem) != block.names.end() && (block.native == 'q' || component != 'w'))
            return std::string{block.native, component};
    return {};
}

bool names_a_body(std::string_view name) {
    const std::string plain = plain_name(name);
    for (const char* body : {"body", "bodyname", "link", "linkname", "name", "object"})
        if (plain == body) return true;
    return false;
}

std::vector<std::string> split(std::string_view text, char at) {
    std::vector<std::string> parts;
    for (std::size_t begin = 0;;) {
        const std::size_t end = text.find(at, begin);
        parts.emplace_back(text.substr(begin, end - begin));
        if (end == text.npos) return parts;
        begin = end + 1;
    }
}

// Returns the place in the header of each of polhode's columns; empty if the table's names are polhode's.
std::map<std::string, std::size_t> recognise_columns(const std::vector<std::string>& header, bool several) {
    const auto is_native = [several](const std::string& name) {
        return std::ranges::find(native_names, name) != native_names.end() || (several && name == "body");
    };
    const auto is_empty = [](const std::string& name) { return plain_name(name).empty(); };
    if (std::ranges::all_of(header, is_native) || std::ranges::any_of(header, is_empty)) return {};
    std::map<std::string, std::size_t> places;
    for (std::size_t i = 0; i < header.size(); ++i) {
        std::optional<std::string> native = is_native(header[i]) ? header[i] : recognise(header[i]);
        if (!native && several && names_a_body(header[i])) native = "body";
        if (native && !places.emplace(*native, i).second) return {};
    }
    for (const char* needed : {"t", "qw", "qx", "qy", "qz"})
        if (!places.contains(needed)) return {};
    return places;
}

std::map<std::string, std::size_t> named_places(const std::vector<std::string>& header, const ColumnNames& names,
                                                const std::string& file, long line) {
    std::map<std::string, std::size_t> places;
    for (const auto& [native, name] : names.theirs) {
        const auto place = std::ranges::find(header, name);
        if (place == header.end())
            throw InputError(file, fmt::format("line {}", line), fmt::format("has no column {}", one_line(name, 60)),
                             fmt::format("its columns are {}", one_line(join_with_commas(header), 300)));
        places.emplace(native, static_cast<std::size_t>(place - header.begin()));
    }
    return places;
}

}  // namespace

ColumnNames parse_columns(std::string_view text) {
    ColumnNames names;
    const auto refuse = [](const std::string& fault) {
        throw std::invalid_argument(
            fault +
            "; give time=T,rotation=X:Y:Z:W (or the nine matrix entries row by row, matrix_by_columns=.., "
            "euler_zyx=A:B:C) and, if available, angular_velocity=X:Y:Z, position=.., origin=.., velocity=..");
    };
    for (const std::string& part : split(text, ',')) {
        const std::size_t equals = part.find('=');
        const std::string block = part.substr(0, equals);
        const std::vector<std::string> given =
            equals == part.npos ? std::vector<std::string>() : split(std::string_view(part).substr(equals + 1), ':');
        std::vector<std::string> native_columns;
        if (block == "time") native_columns = {"t"};
        if (block == "body") native_columns = {"body"};
        if (block == "rotation" && given.size() != 9) native_columns = {"qx", "qy", "qz", "qw"};
        if (block == "rotation" && given.size() == 9)
            for (int i = 0; i < 9; ++i) native_columns.push_back(matrix_entry(i));
        if (block == "matrix_by_columns")
            for (int i = 0; i < 9; ++i) native_columns.push_back(matrix_entry(i % 3 * 3 + i / 3));
        for (const EulerSequence sequence : euler_sequences)
            if (block == fmt::format("euler_{}", name_of(sequence)))
                native_columns = {"e1", "e2", "e3"}, names.sequence = sequence;
        for (const auto& [word, letter] :
             {std::pair{"angular_velocity", "w"}, {"position", "p"}, {"origin", "o"}, {"velocity", "v"}})
            if (block == word)
                for (const char* axis : {"x", "y", "z"}) native_columns.push_back(std::string(letter) + axis);
        if (native_columns.empty()) refuse(fmt::format("{} is not a block of a trajectory", one_line(part, 60)));
        if (given.size() != native_columns.size())
            refuse(fmt::format("{} has {} columns instead of {}", block, given.size(), native_columns.size()));
        for (std::size_t i = 0; i < native_columns.size(); ++i)
            if (given[i].empty() || !names.theirs.emplace(native_columns[i], given[i]).second)
                refuse(fmt::format("{} is given twice or has an empty column name", block));
    }
    return names;
}

ForeignTable find_foreign_columns(std::string_view text, const std::string& file, const ColumnNames& names,
                                  bool several) {
    CsvLines lines(text, file);
    if (!lines.next()) return {};
    const std::vector<std::string> header(lines.cells().begin(), lines.cells().end());
    ForeignColumns columns{
        names.theirs.empty() ? recognise_columns(header, several) : named_places(header, names, file, lines.number()),
        names.sequence, names.degrees};
    if (columns.places.empty()) return {};
    std::vector<std::string> taken, ignored;
    for (const auto& [native, place] : columns.places)
        if (native != header[place]) taken.push_back(fmt::format("{} as {}", header[place], native));
    for (std::size_t i = 0; i < header.size(); ++i)
        if (std::ranges::none_of(columns.places, [&](const auto& p) { return p.second == i; }))
            ignored.push_back(header[i]);
    ForeignTable table{std::move(columns), {}};
    if (!taken.empty()) table.remarks.push_back("columns used: " + one_line(join_with_commas(taken), 400));
    if (!ignored.empty()) table.remarks.push_back("columns ignored: " + one_line(join_with_commas(ignored), 400));
    return table;
}

}  // namespace polhode
