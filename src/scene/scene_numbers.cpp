#include "scene/scene_numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "scene/scene_file.h"
#include "text/message.h"

namespace polhode {
namespace {

using Json = nlohmann::ordered_json;
using Pointer = Json::json_pointer;

// Returns the longest start of a pointer that the document contains.
std::string existing_start(const Json& document, Pointer place) {
    while (!place.empty() && !document.contains(place)) place = place.parent_pointer();
    return place.to_string();
}

Pointer pointer_to_number(const Json& document, const std::string& text, const std::string& file) {
    constexpr std::size_t shown = 80;
    Pointer place;
    try {
        place = Pointer(text);
    } catch (const Json::exception&) {
        throw InputError(file, "", one_line(text, shown) + " is not a JSON pointer", "write it like /body/mass");
    }
    if (!document.contains(place)) {
        const std::string start = existing_start(document, place);
        throw InputError(file, start, fmt::format("has no {}", one_line(text.substr(start.size()), shown)),
                         "give the JSON pointer of a number that polhode show prints");
    }
    if (!document.at(place).is_number())
        throw InputError(file, one_line(text, shown), "is not a number", "give the JSON pointer of a number");
    return place;
}

// The entry on the other side of the diagonal, if the place is in an inertia matrix; otherwise the place itself.
Pointer mirrored(const Pointer& place) {
    const std::string column = place.back();
    const Pointer row = place.parent_pointer(), matrix = row.parent_pointer();
    if (matrix.empty() || matrix.back() != "inertia") return place;
    return matrix / column / row.back();
}

}  // namespace

SceneNumbers::SceneNumbers(const Scene& scene, std::string file)
    : text_(write_scene(scene)), file_(std::move(file)), directory_(scene.directory) {}

double SceneNumbers::number(const std::string& pointer) const {
    const Json document = Json::parse(text_);
    return document.at(pointer_to_number(document, pointer, file_)).get<double>();
}

double SceneNumbers::scale(const std::string& pointer) const {
    const Json document = Json::parse(text_);
    const Pointer place = pointer_to_number(document, pointer, file_);
    double largest = std::abs(document.at(place).get<double>());
    const Json& beside = document.at(place.parent_pointer());
    if (beside.is_array())
        for (const Json& one : beside)
            if (one.is_number()) largest = std::max(largest, std::abs(one.get<double>()));
    return largest > 0 ? largest : 1;
}

Scene SceneNumbers::replace(std::span<const std::string> pointers, std::span<const double> values) const {
    Json document = Json::parse(text_);
    for (std::size_t i = 0; i < pointers.size(); ++i) {
        const Pointer place = pointer_to_number(document, pointers[i], file_);
        document.at(place) = values[i];
        const Pointer other = mirrored(place);
        if (document.contains(other)) document.at(other) = values[i];
    }
    return parse_scene(document.dump(), file_, directory_);
}

}  // namespace polhode
