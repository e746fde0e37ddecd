// A mutator for JSON readers. It changes values, members and entries of a document instead of bytes, so that most
// results are valid JSON and reach the code behind the parser.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace polhode::fuzz {

/// LLVMFuzzerMutate, or its replacement in tests: changes up to `size` bytes in place, to at most `most` bytes.
using MutateBytes = std::size_t (*)(std::uint8_t* data, std::size_t size, std::size_t most);

/// Changes documents at random, reproducibly for a given seed.
class JsonMutator {
  public:
    /// `examples` are documents of the kind to be read; they provide parts, and the member names of objects by key.
    explicit JsonMutator(std::span<const std::string_view> examples);

    /// Changes the document in data[0, size) and returns its new size, at most `most`. Calls `bytes` instead for
    /// invalid JSON, for results that do not fit, and for one in eight of the other inputs.
    std::size_t mutate(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed, MutateBytes bytes) const;

    /// Writes the first document to `out`, with one of its values replaced by a value of the second document, of the
    /// same key where possible. Returns the size, at most `most`, or zero if it does not fit.
    std::size_t cross(std::string_view first, std::string_view second, std::uint8_t* out, std::size_t most,
                      unsigned seed) const;

  private:
    using Json = nlohmann::ordered_json;
    using Random = std::minstd_rand;
    struct Place {
        std::string key;  // key of the nearest enclosing object member
        Json* value;
    };

    void change(Json& document, Random& random) const;
    void change_value(Json& value, Random& random) const;
    void change_members(Json& object, const std::string& key, Random& random) const;
    static void change_entries(Json& array, Random& random);
    static std::vector<Place> places(Json& document);
    static void collect(Json& value, const std::string& key, std::vector<Place>& found);
    static Json number(const Json& before, Random& random);

    std::map<std::string, std::vector<std::pair<std::string, Json>>> members_;  // by the key of their object
    std::map<std::string, std::vector<Json>> values_;                           // by their own key
    std::vector<Json> documents_;
};

}  // namespace polhode::fuzz
