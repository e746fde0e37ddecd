// A strict reader of JSON with comments, for scene files and experiment files.
//
// Every value knows its JSON pointer (RFC 6901), so that errors name their place. Stricter than JSON: no duplicate
// keys, no numbers beyond binary64, nesting of at most 64, valid UTF-8. `//` and `/* */` comments are allowed.
// Getters throw InputError if the value has another type than requested.
#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "text/message.h"

namespace polhode {

/// The type of a JSON value.
enum class JsonKind { null, boolean, number, string, array, object };

/// One value. It belongs to its document and must not outlive it.
class JsonNode {
  public:
    JsonKind kind() const { return kind_; }
    bool is_array() const { return kind_ == JsonKind::array; }
    bool is_object() const { return kind_ == JsonKind::object; }
    bool is_string() const { return kind_ == JsonKind::string; }
    bool is_number() const { return kind_ == JsonKind::number; }

    /// Its key in the enclosing object; empty in an array and at the root.
    const std::string& key() const { return key_; }
    /// JSON pointer (RFC 6901); empty for the whole document.
    std::string pointer() const;

    /// The binary64 nearest to the decimal written; finite.
    double number() const;
    /// An integer of magnitude at most 2^53.
    long whole_number() const;
    bool boolean() const;
    const std::string& string() const;
    /// The elements of an array.
    const std::vector<const JsonNode*>& elements() const;
    /// The members of an object in file order; each has its key().
    const std::vector<const JsonNode*>& members() const;

    /// The member of an object, or nullptr if there is none. Throws if this is not an object.
    const JsonNode* find(std::string_view key) const;
    /// The member of an object. If it is missing, throws an error that tells the user to give `expected`.
    const JsonNode& require_member(std::string_view key, std::string_view expected) const;
    /// Throws at the first member whose key is not among `known`. The message lists the known keys and the near miss.
    void require_known_keys(const std::vector<std::string_view>& known) const;

    /// Throws InputError at this value.
    [[noreturn]] void fail(const std::string& fault, const std::string& remedy) const;
    /// Throws InputError at this value for an error in a file that it refers to.
    [[noreturn]] void fail(const InputError& inner) const;
    /// "is a string", "is -1", "has 2 elements": the first words of an error message.
    std::string describe() const;

  private:
    friend class JsonBuilder;
    void expect(JsonKind kind) const;

    const std::string* file_ = nullptr;
    const JsonNode* parent_ = nullptr;
    std::size_t index_ = 0;  ///< in an array
    std::string key_;
    JsonKind kind_ = JsonKind::null;
    bool boolean_ = false;
    double number_ = 0;
    std::string string_;
    std::vector<const JsonNode*> children_;
};

/// A whole parsed document. `root()` keeps its address when the document is moved.
class JsonDocument {
  public:
    /// Parses `text`; `file` is named in errors. Throws InputError. Syntax errors are located by line, column and
    /// enclosing pointer, all others by pointer.
    JsonDocument(std::string_view text, const std::string& file);

    const JsonNode& root() const { return *root_; }

  private:
    std::unique_ptr<const std::string> file_;
    std::unique_ptr<std::deque<JsonNode>> nodes_;
    const JsonNode* root_ = nullptr;
};

/// The text of a file of at most `largest` bytes. Throws InputError if it cannot be read (missing, a directory, too
/// large); the remedy names what was `expected`.
std::string read_text(const std::string& path, std::size_t largest = std::size_t{16} << 20,
                      const char* expected = "a readable JSON file");

/// `text` as a JSON string with its quotes.
std::string json_string(std::string_view text);

}  // namespace polhode
