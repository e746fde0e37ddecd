#include "fuzz/json_mutator.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <limits>
#include <optional>

namespace polhode::fuzz {
namespace {

using Json = nlohmann::ordered_json;

// nlohmann::json cannot represent duplicate keys or arbitrary number literals. Strings and keys with these marks
// stand for them, and written() removes the marks from the text.
constexpr std::string_view raw_mark = "\x01raw:", twice_mark = "\x01twice";
constexpr std::string_view raw_mark_written = "\"\\u0001raw:", twice_mark_written = "\\u0001twice";

std::optional<Json> parsed(std::string_view text) {
    Json document = Json::parse(text, nullptr, false, true);
    if (document.is_discarded()) return {};
    return document;
}

// Deep documents are mutated as bytes, because writing JSON is recursive.
bool is_deep(std::string_view text) {
    int depth = 0, most = 0;
    for (const char c : text) {
        depth += (c == '[' || c == '{') - (c == ']' || c == '}');
        most = std::max(most, depth);
    }
    return most > 200;
}

std::string written(const Json& document) {
    std::string text = document.dump(-1, ' ', false, Json::error_handler_t::replace);
    for (std::size_t at = text.find(raw_mark_written); at != text.npos; at = text.find(raw_mark_written, at)) {
        text.erase(at, raw_mark_written.size());
        if (const std::size_t end = text.find('"', at); end != text.npos) text.erase(end, 1);
    }
    for (std::size_t at = text.find(twice_mark_written); at != text.npos; at = text.find(twice_mark_written, at))
        text.erase(at, twice_mark_written.size());
    return text;
}

template <class Random>
std::size_t below(std::size_t count, Random& random) {
    return std::uniform_int_distribution<std::size_t>(0, count - 1)(random);
}

template <class Container, class Random>
auto& any(Container& all, Random& random) {
    return all[below(std::size(all), random)];
}

Json raw(const char* text) { return std::string(raw_mark) + text; }

}  // namespace

JsonMutator::JsonMutator(std::span<const std::string_view> examples) {
    for (const std::string_view text : examples) {
        std::optional<Json> document = parsed(text);
        if (!document) continue;
        for (const Place& place : places(*document)) {
            values_[place.key].push_back(*place.value);
            if (!place.value->is_object()) continue;
            for (const auto& [key, value] : place.value->items()) members_[place.key].emplace_back(key, value);
        }
        documents_.push_back(std::move(*document));
    }
}

void JsonMutator::collect(Json& value, const std::string& key, std::vector<Place>& found) {
    found.push_back({key, &value});
    if (value.is_object())
        for (auto item = value.begin(); item != value.end(); ++item) collect(item.value(), item.key(), found);
    if (value.is_array())
        for (Json& entry : value) collect(entry, key, found);
}

std::vector<JsonMutator::Place> JsonMutator::places(Json& document) {
    std::vector<Place> found;
    collect(document, "", found);
    return found;
}

Json JsonMutator::number(const Json& before, Random& random) {
    static const char* const extremes[] = {
        "0",      "-0.0",   "1",      "-1",      "4.9e-324", "2.2250738585072014e-308",
        "1e-308", "1e-154", "1e-160", "1e154",   "1e155",    "1.7976931348623157e308",
        "1e308",  "-1e308", "1e309",  "1e-400",  "1e-1000",  "9007199254740993",
        "64",     "65",     "1e6",    "1000001", "1e15",     "18446744073709551616",
        "0.1",    "1e-6",   "1e-12",  "1e-13",   "1e-16",    "3.141592653589793"};
    const double x = before.is_number() ? before.get<double>() : 1;
    const double infinite = std::numeric_limits<double>::infinity();
    double y = x;
    switch (below(8, random)) {
        case 0:
            return raw(any(extremes, random));
        case 1:
            y = std::nextafter(x, below(2, random) ? infinite : -infinite);
            break;
        case 2:
            y = -x;
            break;
        case 3:
            y = x * std::pow(10, std::uniform_real_distribution<double>(-20, 20)(random));
            break;
        case 4:
            y = std::uniform_real_distribution<double>(-10, 10)(random);
            break;
        case 5:
            y = x * (1 + std::uniform_real_distribution<double>(-1e-5, 1e-5)(random));
            break;
        case 6:
            y = std::round(x) + static_cast<double>(below(3, random)) - 1;
            break;
        default:
            // any bit pattern
            const std::uint64_t bits = std::uint64_t{random()} << 33 ^ std::uint64_t{random()} << 11 ^ random();
            std::memcpy(&y, &bits, sizeof y);
    }
    return std::isfinite(y) ? Json(y) : raw("1e309");
}

void JsonMutator::change_value(Json& value, Random& random) const {
    const std::size_t way = below(10, random);
    if (value.is_number() && way < 8) {
        value = number(value, random);
    } else if (value.is_boolean() && way < 6) {
        value = !value.get<bool>();
    } else {
        // a value of another type
        static const Json others[] = {nullptr,
                                      true,
                                      false,
                                      0,
                                      1.5,
                                      "",
                                      "world",
                                      Json::array(),
                                      Json::object(),
                                      Json::array({0, 0, 1}),
                                      Json::array({1, 0, 0, 0}),
                                      Json::array({Json::array({1, 0, 0})})};
        value = any(others, random);
    }
}

void JsonMutator::change_members(Json& object, const std::string& key, Random& random) const {
    const std::size_t way = below(8, random);
    if (object.empty() || way < 4) {
        const auto known = members_.find(key);
        if (known == members_.end()) return;
        const auto& [name, value] = any(known->second, random);
        object[name] = value;
        return;
    }
    auto member = object.begin();
    std::advance(member, below(object.size(), random));
    const std::string name = member.key();
    const Json value = member.value();
    if (way < 6) {
        object.erase(name);
    } else if (way == 6) {
        object[name + std::string(twice_mark)] = value;
    } else {
        object.erase(name);
        const auto known = members_.find(key);
        object[known == members_.end() ? name + "x" : any(known->second, random).first] = value;
    }
}

void JsonMutator::change_entries(Json& array, Random& random) {
    const std::size_t way = below(4, random);
    if (array.empty()) {
        array.push_back(0);
        return;
    }
    const std::size_t i = below(array.size(), random), j = below(array.size(), random);
    if (way == 0) {
        array.erase(i);
    } else if (way == 1) {
        const Json copy = array[i];
        array.insert(array.begin() + static_cast<std::ptrdiff_t>(j), copy);
    } else if (way == 2) {
        std::swap(array[i], array[j]);
    } else {
        const Json copy = array;
        array[i] = copy;
    }
}

void JsonMutator::change(Json& document, Random& random) const {
    std::vector<Place> all = places(document);
    const Place& place = any(all, random);
    const auto known = values_.find(place.key);
    // first choice: a value of the same key from the examples
    if (below(4, random) == 0 && known != values_.end()) {
        *place.value = any(known->second, random);
    } else if (below(32, random) == 0 && !documents_.empty()) {
        document = any(documents_, random);
    } else if (place.value->is_object()) {
        change_members(*place.value, place.key, random);
    } else if (place.value->is_array() && below(3, random) != 0) {
        change_entries(*place.value, random);
    } else if (below(40, random) == 0) {
        // deeper nesting
        Json inner = *place.value;
        for (std::size_t depth = below(70, random); depth-- > 0;) inner = Json::array({std::move(inner)});
        *place.value = std::move(inner);
    } else {
        change_value(*place.value, random);
    }
}

std::size_t JsonMutator::mutate(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed,
                                MutateBytes bytes) const {
    Random random(seed % 2147483646u + 1);
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    if (below(8, random) == 0 || is_deep(text)) return bytes(data, size, most);
    std::optional<Json> document = parsed(text);
    if (!document) return bytes(data, size, most);
    for (std::size_t changes = 1 + below(4, random); changes > 0; --changes) change(*document, random);
    const std::string out = written(*document);
    if (out.size() > most) return bytes(data, size, most);
    std::memcpy(data, out.data(), out.size());
    return out.size();
}

std::size_t JsonMutator::cross(std::string_view first, std::string_view second, std::uint8_t* out, std::size_t most,
                               unsigned seed) const {
    Random random(seed % 2147483646u + 1);
    if (is_deep(first) || is_deep(second)) return 0;
    std::optional<Json> into = parsed(first), from = parsed(second);
    if (!into || !from) return 0;
    std::vector<Place> targets = places(*into), sources = places(*from);
    const Place& source = any(sources, random);
    std::vector<Place> alike;
    for (const Place& place : targets)
        if (place.key == source.key) alike.push_back(place);
    *(alike.empty() ? any(targets, random) : any(alike, random)).value = *source.value;
    const std::string text = written(*into);
    if (text.size() > most) return 0;
    std::memcpy(out, text.data(), text.size());
    return text.size();
}

}  // namespace polhode::fuzz
