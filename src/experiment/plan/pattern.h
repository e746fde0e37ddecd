// Regular expressions of the user's own: POSIX extended ones, whose matching cannot run away.
#pragma once

#include <memory>
#include <string>

namespace polhode {

class Pattern {
  public:
    /// Throws std::invalid_argument, with the reason, where the expression is none, or one that the system's compiler
    /// of expressions could not be trusted with: more than 500 characters, or than 1000 with its repetitions written
    /// out (each of *, ? and + doubles what it repeats), parentheses deeper than 50, back references, collating
    /// elements, a zero byte.
    explicit Pattern(const std::string& expression);

    /// Whether it matches anywhere in the text. An empty expression matches everything.
    bool matches(const std::string& text) const;

  private:
    struct Compiled;
    std::shared_ptr<const Compiled> compiled_;
};

}  // namespace polhode
