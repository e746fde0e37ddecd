// The keys of input files as data. The reader and the reference page use the same table.
#pragma once

#include <span>
#include <string_view>
#include <vector>

namespace polhode {

/// A key of an object in an input file.
struct FileKey {
    std::string_view object;    ///< the object it belongs to: "scene", "load force"
    std::string_view key;       ///< its name
    std::string_view type;      ///< "number", "[x, y, z]", ..
    std::string_view unit;      ///< unit of its numbers; empty if dimensionless
    std::string_view fallback;  ///< default value, or "required"
    std::string_view example;   ///< as written in a file
    std::string_view meaning;   ///< description for readers, without a full stop
};

/// The names of an object's keys in table order, as JsonNode::only expects them.
inline std::vector<std::string_view> keys_of(std::span<const FileKey> table, std::string_view object) {
    std::vector<std::string_view> names;
    for (const FileKey& key : table)
        if (key.object == object) names.push_back(key.key);
    return names;
}

}  // namespace polhode
