// The keys of files that people write, as data: what a reader knows and what its reference says are the same table.
#pragma once

#include <span>
#include <string_view>
#include <vector>

namespace polhode {

/// A key of an object in a file.
struct FileKey {
    std::string_view object;    ///< which object it stands in: "scene", "load force"
    std::string_view key;       ///< its name
    std::string_view type;      ///< "number", "[x, y, z]", ..
    std::string_view unit;      ///< of its numbers; empty where they have none
    std::string_view fallback;  ///< what it is when it is left out, or "required"
    std::string_view example;   ///< as it stands in a file
    std::string_view meaning;   ///< for people, without a full stop
};

/// The names of an object's keys, in the table's order: what JsonNode::only takes.
inline std::vector<std::string_view> keys_of(std::span<const FileKey> table, std::string_view object) {
    std::vector<std::string_view> names;
    for (const FileKey& key : table)
        if (key.object == object) names.push_back(key.key);
    return names;
}

}  // namespace polhode
