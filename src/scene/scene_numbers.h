// Scenes in which single numbers are replaced, by JSON pointer.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace polhode {

/// A scene whose numbers can be replaced. Pointers refer to the canonical form of the scene (write_scene()), which
/// contains most defaults.
class SceneNumbers {
  public:
    /// `file` is named in errors.
    SceneNumbers(const Scene& scene, std::string file);

    /// Returns the number at a JSON pointer. Throws InputError if it points to no number.
    double number(const std::string& pointer) const;

    /// Returns the largest magnitude of the number and of those beside it in a list, or 1 if it is 0.
    double scale(const std::string& pointer) const;

    /// Returns the scene with other numbers at the pointers. Of an inertia matrix, both entries of a pair off the
    /// diagonal change. Throws InputError if the result is invalid.
    Scene replace(std::span<const std::string> pointers, std::span<const double> values) const;

  private:
    std::string text_, file_, directory_;
};

}  // namespace polhode
