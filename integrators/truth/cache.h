// Cache of reference solutions on disk, addressed by content: each is computed once per scene.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "integrators/truth/attempt.h"
#include "scene/scene.h"
#include "text/claims.h"

namespace polhode::truth {

/// Generated hash of the sources that compute a reference, of their compiler and of the header-only libraries.
const char* program_sources();

/// Identifies the program that computes a reference: program_sources() and the versions of MPFR and GMP.
std::string program();

/// Hash of all inputs of a reference at equally spaced samples: the scene without its name and texts, the number of
/// samples, the digits, and `by`, the program that computes it. Results of other code are therefore never found, and no
/// version number has to be maintained by hand.
std::string cache_key(const Scene& scene, long samples, int digits, const std::string& by = program());

/// Hash of all inputs of a reference at the given times, s.
std::string cache_key(const Scene& scene, const std::vector<double>& times, int digits,
                      const std::string& by = program());

/// Returns the reference cached under `key`. Returns nothing if there is none or if the file is damaged or foreign; in
/// the latter case, reports it in one line on standard error.
std::optional<Truth> read_cached(const std::string& key);

/// The text of a cache file: lines with the mark, the key and the message, then numbers, then a checksum of all of it.
std::string encode(const std::string& key, const Truth& truth);

/// Decodes the text of encode(). Returns nothing if the text is damaged, belongs to another key or has another format.
std::optional<Truth> decode(const std::string& key, std::string_view text);

/// Writes the reference to the cache atomically. Write errors are ignored: the reference is then computed again.
void store(const std::string& key, const Truth& truth);

/// During its lifetime, no other process with the same cache computes the reference of this key.
class CacheClaim {
  public:
    /// Waits while another process holds the claim, until is_over() returns true.
    CacheClaim(const std::string& key, const std::function<bool()>& is_over);

  private:
    std::optional<Claims> claims_;
    std::optional<Claims::Claim> claim_;
};

/// The path of the cache file of `key`; empty if there is no cache directory.
std::string cache_path(const std::string& key);

}  // namespace polhode::truth
