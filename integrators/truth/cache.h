// The truth on disk, by content: computed once for a scene, whoever asks.
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

/// The identity of the source files that compute a truth, of their compiler, and of the libraries that are headers
/// alone; generated as the program is built.
const char* program_sources();

/// What computes a truth: those sources, and the versions of MPFR and GMP.
std::string program();

/// The hash of all that a truth at equally spaced samples depends on: the scene without its name and texts, the number
/// of samples, the digits, and `by`, what computes it. So a truth that other code has made is never found, and no
/// number has to be raised by hand where code changes.
std::string cache_key(const Scene& scene, long samples, int digits, const std::string& by = program());

/// The hash of all that a truth at times of the caller's own (s) depends on.
std::string cache_key(const Scene& scene, const std::vector<double>& times, int digits,
                      const std::string& by = program());

/// The truth kept under `key`; nothing where there is none, or the file is torn or foreign: of that one line on
/// standard error tells.
std::optional<Truth> cached(const std::string& key);

/// The text of a cache file: lines of a mark, key and message, then numbers, then a checksum over all of it.
std::string encode(const std::string& key, const Truth& truth);

/// The truth that encode() wrote; nothing where the text is torn, of another key, or anything else.
std::optional<Truth> decode(const std::string& key, std::string_view text);

/// Keeps it, atomically. A cache that cannot be written is no fault: the truth is computed again.
void keep(const std::string& key, const Truth& truth);

/// While it lives, no other process that uses this cache computes the truth of its key.
class CacheClaim {
  public:
    /// Waits while another process has the claim, but no longer than until is_over() says so.
    CacheClaim(const std::string& key, const std::function<bool()>& is_over);

  private:
    std::optional<Claims> claims_;
    std::optional<Claims::Claim> claim_;
};

/// Where the file of `key` is or would be; empty where there is no place for a cache.
std::string cache_path(const std::string& key);

}  // namespace polhode::truth
