// User-supplied regular expressions (POSIX extended) with bounded memory and time.
#pragma once

#include <memory>
#include <string>

namespace polhode {

class Pattern {
  public:
    /// Throws std::invalid_argument with the reason if the expression is invalid or if regcomp() could take too much
    /// memory or time: more than 500 characters, more than 1000 with repetitions expanded (each of *, ? and + doubles
    /// what it repeats), parentheses nested more than 50 deep, back references, collating elements, a zero byte.
    explicit Pattern(const std::string& expression);

    /// Whether the expression matches anywhere in the text. An empty expression matches everything.
    bool matches(const std::string& text) const;

  private:
    struct Compiled;
    std::shared_ptr<const Compiled> compiled_;
};

}  // namespace polhode
