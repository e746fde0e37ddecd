// Builds JsonDocument from the events of nlohmann::json's SAX parser (sax_parse, comments enabled).
//
// JsonBuilder stores the nodes in one deque, so that their addresses are stable, and enforces the limits of
// json_limits.h and the ban on duplicate keys while it parses. JsonNode::pointer() walks up the parents, so that only
// errors pay for it. Zero bytes, unprintable characters and invalid UTF-8 are refused before parsing.

#include "text/json_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <unordered_set>

#include "text/decimal.h"
#include "text/json_limits.h"
#include "text/message.h"
#include "text/named_file.h"
#include "text/printable.h"

namespace polhode {
namespace {

// RFC 6901: ~ and / are escaped. A long key is shortened, since pointers appear in messages.
std::string pointer_token(std::string_view key) {
    std::string token;
    for (const char c : one_line(key, 60)) token += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
    return token;
}

const char* name_of(JsonKind kind) {
    switch (kind) {
        case JsonKind::null:
            return "null";
        case JsonKind::boolean:
            return "true or false";
        case JsonKind::number:
            return "a number";
        case JsonKind::string:
            return "a string";
        case JsonKind::array:
            return "an array";
        case JsonKind::object:
            break;
    }
    return "an object";
}

std::string line_and_column(std::string_view text, std::size_t offset) {
    const std::string_view before = text.substr(0, std::min(offset, text.size()));
    const auto line = std::count(before.begin(), before.end(), '\n') + 1;
    const std::size_t newline = before.rfind('\n');
    return fmt::format("line {}, column {}", line, before.size() - (newline == before.npos ? 0 : newline + 1) + 1);
}

// The word around `offset`, for literals such as -Infinity.
std::string_view word_at(std::string_view text, std::size_t offset) {
    const auto part = [](char c) { return c == '-' || c == '+' || ((c | 32) >= 'a' && (c | 32) <= 'z'); };
    std::size_t begin = std::min(offset, text.size()), end = begin;
    while (begin > 0 && part(text[begin - 1])) --begin;
    while (end < text.size() && part(text[end])) ++end;
    return text.substr(begin, end - begin);
}

bool names_no_number(std::string_view word) {
    std::string lower;
    for (const char c : word)
        if (c != '-' && c != '+') lower += static_cast<char>(c | 32);
    return lower == "nan" || lower == "inf" || lower == "infinity";
}

}  // namespace

// Builds the tree from the events of the parser.
class JsonBuilder {
  public:
    using Json = nlohmann::json;

    JsonBuilder(std::string_view text, const std::string& file, std::deque<JsonNode>& nodes)
        : text_(text), file_(file), nodes_(nodes) {}

    bool null() { return add(JsonKind::null), true; }
    bool boolean(bool value) { return add(JsonKind::boolean).boolean_ = value, true; }
    bool number_integer(std::int64_t value) { return number(static_cast<double>(value)); }
    bool number_unsigned(std::uint64_t value) { return number(static_cast<double>(value)); }
    bool number_float(double value, const std::string&) { return number(value); }
    bool string(std::string& value) { return add(JsonKind::string).string_ = std::move(value), true; }
    bool binary(Json::binary_t&) { return false; }
    bool start_object(std::size_t) {
        open(JsonKind::object);
        keys_.emplace_back();
        return true;
    }
    bool start_array(std::size_t) { return open(JsonKind::array), true; }
    bool end_array() { return open_.pop_back(), true; }
    bool end_object() {
        keys_.pop_back();
        return end_array();
    }
    bool key(std::string& value) {
        if (!keys_.back().insert(value).second)
            throw InputError(file_, open_.back()->pointer() + "/" + pointer_token(value),
                             "is a duplicate key of this object", "give it once");
        key_ = std::move(value), has_key_ = true;
        return true;
    }
    bool parse_error(std::size_t position, const std::string&, const nlohmann::detail::exception& error) {
        if (error.id == 406)  // nlohmann::json out_of_range.406: a number beyond binary64
            throw InputError(file_, place(), "is too large for binary64", "give a finite number");
        const std::size_t offset = position > 0 ? position - 1 : 0;
        if (const std::string_view word = word_at(text_, offset); names_no_number(word))
            throw InputError(file_, place(), fmt::format("is {}, which is not a number in JSON", word),
                             "give a finite number");
        std::string fault = error.what();
        if (const std::size_t column = fault.find("column "); column != fault.npos)
            if (const std::size_t colon = fault.find(": ", column); colon != fault.npos) fault.erase(0, colon + 2);
        std::string at = line_and_column(text_, offset);
        if (const std::string inside = place(); !inside.empty()) at += ", in " + inside;
        throw InputError(file_, at, fault, "give JSON (comments by // and /* */ are allowed)");
    }

  private:
    JsonNode& add(JsonKind kind) {
        if (nodes_.size() == most_json_values)
            throw InputError(file_, place(), fmt::format("the file has more than {} values", most_json_values),
                             "give fewer values");
        JsonNode& node = nodes_.emplace_back();
        node.file_ = &file_, node.kind_ = kind;
        if (!open_.empty()) {
            node.parent_ = open_.back(), node.index_ = open_.back()->children_.size();
            if (has_key_) node.key_ = std::move(key_);
            open_.back()->children_.push_back(&node);
        }
        has_key_ = false;
        return node;
    }
    bool number(double value) { return add(JsonKind::number).number_ = value, true; }
    void open(JsonKind kind) {
        if (open_.size() == deepest_json)
            throw InputError(file_, place(), fmt::format("is nested more than {} levels deep", deepest_json),
                             "reduce the nesting");
        open_.push_back(&add(kind));
    }
    // JSON pointer of the value that comes next
    std::string place() const {
        if (open_.empty()) return "";
        const JsonNode& node = *open_.back();
        if (has_key_) return node.pointer() + "/" + pointer_token(key_);
        return node.is_array() ? fmt::format("{}/{}", node.pointer(), node.children_.size()) : node.pointer();
    }

    std::string_view text_;
    const std::string& file_;
    std::deque<JsonNode>& nodes_;
    std::vector<JsonNode*> open_;
    std::vector<std::unordered_set<std::string>> keys_;  // keys seen in each open object
    std::string key_;
    bool has_key_ = false;
};

JsonDocument::JsonDocument(std::string_view text, const std::string& file)
    : file_(std::make_unique<const std::string>(file)), nodes_(std::make_unique<std::deque<JsonNode>>()) {
    if (text.size() > largest_json)
        throw InputError(file, "", fmt::format("is larger than {} MiB", largest_json >> 20), "give a smaller file");
    if (const std::size_t bad = first_invalid_utf8(text); bad != text.npos)
        throw InputError(file, line_and_column(text, bad), "is not UTF-8", "save the file as UTF-8");
    if (const std::size_t zero = text.find('\0'); zero != text.npos)
        throw InputError(file, line_and_column(text, zero), "is a zero byte", "give JSON text");
    // also applies to comments, since `polhode show` prints them
    if (const std::size_t bad = first_unprintable(text); bad != text.npos)
        throw InputError(file, line_and_column(text, bad),
                         fmt::format("is the control character {}", one_line(text.substr(bad, 4), 16)),
                         "give JSON text; in a string write it as \\uXXXX");
    if (text.find_first_not_of(" \t\r\n") == text.npos)
        throw InputError(file, "", "is empty", "give a JSON object: {\"name\": ..}");
    JsonBuilder builder(text, *file_, *nodes_);
    nlohmann::json::sax_parse(text.begin(), text.end(), &builder, nlohmann::json::input_format_t::json, true, true);
    root_ = &nodes_->front();
}

std::string JsonNode::pointer() const {
    if (!parent_) return "";
    return parent_->pointer() + "/" + (parent_->is_array() ? std::to_string(index_) : pointer_token(key_));
}

std::string JsonNode::describe() const {
    switch (kind_) {
        case JsonKind::boolean:
            return boolean_ ? "is true" : "is false";
        case JsonKind::number:
            return "is " + shortest_decimal(number_);
        case JsonKind::string:
            return "is the string " + json_string(one_line(string_, 60));
        case JsonKind::array:
            return fmt::format("is an array of length {}", children_.size());
        case JsonKind::null:
        case JsonKind::object:
            break;
    }
    return fmt::format("is {}", name_of(kind_));
}

void JsonNode::fail(const std::string& fault, const std::string& remedy) const {
    throw InputError(*file_, pointer(), fault, remedy);
}

void JsonNode::fail(const InputError& inner) const { throw InputError(*file_, pointer(), inner); }

void JsonNode::expect(JsonKind kind) const {
    if (kind_ != kind) fail(describe(), fmt::format("give {}", name_of(kind)));
}

double JsonNode::number() const {
    expect(JsonKind::number);
    return number_;
}

long JsonNode::whole_number() const {
    expect(JsonKind::number);
    if (std::trunc(number_) != number_ || std::abs(number_) > 0x1p53) fail(describe(), "give a whole number");
    return static_cast<long>(number_);
}

bool JsonNode::boolean() const {
    expect(JsonKind::boolean);
    return boolean_;
}

const std::string& JsonNode::string() const {
    expect(JsonKind::string);
    return string_;
}

const std::vector<const JsonNode*>& JsonNode::elements() const {
    expect(JsonKind::array);
    return children_;
}

const std::vector<const JsonNode*>& JsonNode::members() const {
    expect(JsonKind::object);
    return children_;
}

const JsonNode* JsonNode::find(std::string_view key) const {
    for (const JsonNode* member : members())
        if (member->key_ == key) return member;
    return nullptr;
}

const JsonNode& JsonNode::require_member(std::string_view key, std::string_view expected) const {
    if (const JsonNode* member = find(key)) return *member;
    throw InputError(*file_, pointer() + "/" + pointer_token(key), "is missing", fmt::format("give {}", expected));
}

void JsonNode::require_known_keys(const std::vector<std::string_view>& known) const {
    for (const JsonNode* member : members()) {
        if (std::find(known.begin(), known.end(), member->key_) != known.end()) continue;
        const std::vector<std::string> keys(known.begin(), known.end());
        const std::string meant = did_you_mean(member->key_, keys);
        member->fail("is an unknown key",
                     fmt::format("{}{}known keys: {}", meant, meant.empty() ? "" : " ", join_with_commas(keys)));
    }
}

std::string read_text(const std::string& path, std::size_t largest, const char* expected) {
    return read_whole_file(path, path, largest, expected, FileKinds::streamed);
}

std::string json_string(std::string_view text) {
    std::string quoted = "\"";
    while (!text.empty()) {
        std::uint32_t point = 0;
        // bytes that are not UTF-8 are copied; other checks report them
        const std::size_t sequence = sequence_length(text, point), length = std::max<std::size_t>(sequence, 1);
        const char c = text[0];
        if (c == '"' || c == '\\')
            quoted += {'\\', c};
        else if (c == '\n')
            quoted += "\\n";
        else if (c == '\t')
            quoted += "\\t";
        else if (sequence > 0 && !is_printable(point))
            quoted += fmt::format("\\u{:04x}", point);
        else
            quoted += text.substr(0, length);
        text.remove_prefix(length);
    }
    return quoted + '"';
}

}  // namespace polhode
