// A mutator for readers of JSON: changes values, members and entries of a document instead of its bytes, so that most
// of what comes out is JSON still and reaches what lies behind the syntax.
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

/// LLVMFuzzerMutate, or what a test puts in its place: changes up to `size` bytes in place, to at most `most`.
using MutateBytes = std::size_t (*)(std::uint8_t* data, std::size_t size, std::size_t most);

/// Changes documents at random, the same way for the same seed.
class JsonMutator {
  public:
    /// `examples` are documents of the kind that is read: which members stand in an object is learnt from them by the
    /// key that the object itself stands under, and each is a source of parts.
    explicit JsonMutator(std::span<const std::string_view> examples);

    /// Changes the document in data[0, size) and gives its new size, at most `most`. A text that is no JSON, a document
    /// that would not fit, and one in eight others are left to `bytes`.
    std::size_t mutate(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed, MutateBytes bytes) const;

    /// The first document with a part of the second in the place of one of its own that stands under the same key,
    /// where there is one; at most `most` bytes, zero where it would not fit.
    std::size_t cross(std::string_view first, std::string_view second, std::uint8_t* out, std::size_t most,
                      unsigned seed) const;

  private:
    using Json = nlohmann::ordered_json;
    using Random = std::minstd_rand;
    struct Place {
        std::string key;  // of the nearest object's member that it is, or is in
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
