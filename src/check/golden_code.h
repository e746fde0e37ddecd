// Building blocks of golden data as text: numbers, names, comments, and constants of C, C++ and C#.
#pragma once

#include <fmt/format.h>

#include <cctype>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "check/golden.h"
#include "text/decimal.h"
#include "text/message.h"

namespace polhode::golden_code {

using nlohmann::ordered_json;

// Numbers as they are written: 0 for magnitudes that could underflow, rounded to binary32 for floats.
struct Numbers {
    bool floats = false;

    double operator()(double x) const {
        if (std::abs(x) < 1e-300) return 0;
        const double written = floats ? std::strtod(fmt::format("{}", static_cast<float>(x)).c_str(), nullptr) : x;
        if (!std::isfinite(written))
            throw std::invalid_argument(
                fmt::format("{} is outside the range of {}; {}", shortest_decimal(x), floats ? "binary32" : "binary64",
                            floats ? "omit --floats or choose other units" : "choose other units"));
        return written;
    }
    ordered_json operator()(const Vector3<double>& v) const { return {(*this)(v[0]), (*this)(v[1]), (*this)(v[2])}; }
    ordered_json operator()(const Matrix3<double>& m) const { return {(*this)(m[0]), (*this)(m[1]), (*this)(m[2])}; }
    ordered_json operator()(const Quaternion<double>& q, bool scalar_last) const {
        const Numbers& n = *this;
        if (scalar_last) return {n(q.x), n(q.y), n(q.z), n(q.w)};
        return {n(q.w), n(q.x), n(q.y), n(q.z)};
    }
    ordered_json all_of(ordered_json document) const {
        if (document.is_number()) return (*this)(document.get<double>());
        if (document.is_structured())
            for (ordered_json& part : document) part = all_of(std::move(part));
        return document;
    }
};

// Whether the rows have a column `body`.
inline bool has_several_bodies(const Golden& g) { return !g.motion.bodies.empty(); }
inline bool scalar_last(const Golden& g) { return g.convention.quaternion == QuaternionColumns::scalar_last; }

inline std::string axes_of(const Golden& g) {
    const std::string words = name_of(g.convention);
    return words.empty() ? "z up, right-handed, radians, quaternion w,x,y,z" : words;
}

// Converts a name to an identifier: "9 lives!" becomes 9_lives.
inline std::string identifier(const std::string& name) {
    std::string result;
    for (const char c : name) {
        const auto byte = static_cast<unsigned char>(c);
        const bool plain = byte < 0x80 && std::isalnum(byte) != 0;
        // one _ for other characters, never two in a row: C++ reserves such names
        if (plain)
            result += c;
        else if (!result.empty() && result.back() != '_')
            result += '_';
    }
    while (!result.empty() && result.back() == '_') result.pop_back();
    return result.empty() ? "scene" : result;
}

// Makes a text safe inside a comment: no start or end of a comment, no trigraphs.
inline std::string comment(const std::string& text, std::size_t limit = 1000) {
    std::string safe = one_line(text, limit);
    for (std::size_t i = 0; i + 1 < safe.size(); ++i)
        if ((safe[i] == '*' && safe[i + 1] == '/') || (safe[i] == '/' && safe[i + 1] == '*') ||
            (safe[i] == '?' && safe[i + 1] == '?'))
            safe.insert(i + 1, 1, ' ');
    return safe;
}

// A constant in the code: an integer, a number, or a list or table of numbers.
struct Field {
    std::string name;
    ordered_json value;
    std::string remark;  // comment: its unit
};

// Fields in the order of the output.
struct FieldList {
    std::vector<Field> fields;

    void add(std::string name, ordered_json value, std::string remark) {
        fields.push_back({std::move(name), std::move(value), std::move(remark)});
    }
};

// Writes constants in one language.
struct Language {
    GoldenFormat format;
    bool floats;

    const char* real() const { return floats ? "float" : "double"; }
    std::string literal(const ordered_json& x) const {
        if (x.is_number_integer() || x.is_number_unsigned()) return x.dump();
        std::string text = shortest_decimal(x.get<double>());
        if (text.find_first_of(".e") == text.npos) text += ".0";
        return floats ? text + "f" : text;
    }
    // each row of a table is on its own line
    std::string list(const ordered_json& x) const {
        if (!x.is_array()) return literal(x);
        const bool lines = x.size() > 3 && x.front().is_array();
        // a std::array of std::arrays needs double braces
        std::string text = format == GoldenFormat::cpp && x.front().is_array() ? "{{" : "{";
        for (std::size_t i = 0; i < x.size(); ++i)
            text += (i == 0 ? "" : ",") + std::string(lines ? "\n    " : i == 0 ? "" : " ") + list(x[i]);
        return text + (lines ? "\n" : "") + (format == GoldenFormat::cpp && x.front().is_array() ? "}}" : "}");
    }
    std::string constant(const std::string& prefix, const Field& f) const {
        const bool whole = f.value.is_number_integer() || f.value.is_number_unsigned();
        const bool array = f.value.is_array(), table = array && f.value.front().is_array();
        const std::string type = whole ? "int" : real();
        const std::string remark = f.remark.empty() ? "" : fmt::format(" /* {} */", comment(f.remark));
        if (format == GoldenFormat::csharp)
            return fmt::format("    public {} {}{} {} = {};{}\n", array ? "static readonly" : "const", type,
                               table   ? "[,]"
                               : array ? "[]"
                                       : "",
                               f.name, list(f.value), remark);
        if (format == GoldenFormat::c) {
            if (whole) return fmt::format("enum {{ {}{} = {} }};{}\n", prefix, f.name, list(f.value), remark);
            return fmt::format("static const {} {}{}{}{} = {};{}\n", type, prefix, f.name,
                               array ? fmt::format("[{}]", f.value.size()) : "",
                               table ? fmt::format("[{}]", f.value.front().size()) : "", list(f.value), remark);
        }
        std::string holder = type;
        if (table) holder = fmt::format("std::array<{}, {}>", type, f.value.front().size());
        if (array) holder = fmt::format("std::array<{}, {}>", holder, f.value.size());
        return fmt::format("inline constexpr {} {} = {};{}\n", holder, f.name, list(f.value), remark);
    }
};

inline std::string replace_all(std::string text, const std::string& what, const std::string& by) {
    for (std::size_t at = text.find(what); at != text.npos; at = text.find(what, at + by.size()))
        text.replace(at, what.size(), by);
    return text;
}

/// The number of a plane's law of restitution in the code, and the comment that explains the numbers.
inline int restitution_law_number(const std::string& law) { return law == "stronge" ? 0 : law == "poisson" ? 1 : 2; }
inline constexpr const char* restitution_laws = "0 stronge, 1 poisson, 2 newton";

/// The pieces of a body's hull as JSON.
ordered_json shape_of(const std::vector<SupportPiece<double>>& pieces, const Numbers& number);
/// Copies the parameters, tables and definitions that formulas use, if there are any.
void add_names_of_formulas(const ordered_json& written, ordered_json& all);
/// The bodies, joints, loops, planes, contacts and loads of a scene of several bodies, in the form of scene files.
ordered_json system_surroundings(const Golden& golden, const Numbers& number);
/// The constants of these parts. They refer to bodies and joints by index. `m`: the unit of length.
void add_system_fields(const Golden& golden, const ordered_json& surroundings, const std::string& m, FieldList& all);

}  // namespace polhode::golden_code
