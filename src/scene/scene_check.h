// Helpers for validating the values of a scene, with errors located inside it.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "scene/body_source.h"
#include "scene/scene.h"
#include "scene/scene_limits.h"
#include "text/decimal.h"
#include "text/message.h"
#include "text/printable.h"

namespace polhode {

/// Throws InputError at places (JSON pointers) inside one scene.
class SceneCheck {
  public:
    explicit SceneCheck(const std::string& file) : file_(file) {}

    [[noreturn]] void fail(const std::string& place, const std::string& fault, const std::string& remedy) const {
        throw InputError(file_, place, fault, remedy);
    }
    void finite(const std::string& place, double value) const {
        if (!std::isfinite(value)) fail(place, "is " + shortest_decimal(value), "give a finite number");
    }
    void finite(const std::string& place, const Vector3<double>& v) const {
        for (int i = 0; i < 3; ++i) finite(fmt::format("{}/{}", place, i), v[i]);
    }
    void positive(const std::string& place, double value, const char* what) const {
        finite(place, value);
        if (!(value > 0)) fail(place, "is " + shortest_decimal(value), fmt::format("{} must be > 0", what));
        if (!std::isfinite(1 / value))
            fail(place, "is " + shortest_decimal(value), fmt::format("{} must have a finite inverse: >= 1e-307", what));
    }
    void not_negative(const std::string& place, double value, const char* what) const {
        finite(place, value);
        if (!(value >= 0)) fail(place, "is " + shortest_decimal(value), fmt::format("{} must be >= 0", what));
        if (value > 0) positive(place, value, what);
    }
    void unit(const std::string& place, const Quaternion<double>& q) const {
        const double component[4] = {q.w, q.x, q.y, q.z};
        for (int i = 0; i < 4; ++i) finite(fmt::format("{}/{}", place, i), component[i]);
        if (const std::string fault = norm_fault(q); !fault.empty()) fail(place, fault, norm_remedy);
    }
    /// Checks a direction: finite, of any nonzero length.
    void direction(const std::string& place, const Vector3<double>& v) const {
        finite(place, v);
        const Wide length = square_root(dot(cast<Wide>(v), cast<Wide>(v)));
        if (!(length > 0)) fail(place, "is zero", "give a direction: a vector of nonzero length");
        if (!std::isfinite(double(1 / length)))
            fail(place, "is too short", "the length of a direction must have a finite inverse: >= 1e-307");
    }
    void count(const std::string& place, std::size_t count, std::size_t most, const char* what) const {
        if (count > most) fail(place, fmt::format("has {} {}", count, what), fmt::format("give at most {}", most));
    }
    /// Checks a name that appears in tables. A spreadsheet interprets text with these first characters as a formula.
    void name(const std::string& place, const std::string& value) const {
        if (value.size() > longest_scene_name)
            fail(place, fmt::format("has {} bytes", value.size()),
                 fmt::format("a name has at most {} bytes", longest_scene_name));
        if (value.find_first_of("=+-@") == 0)
            fail(place, fmt::format("begins with \"{}\"", value[0]),
                 "use a name that a spreadsheet does not interpret as a formula");
    }
    /// Checks a text that is shown to readers.
    void shown(const std::string& place, const std::string& value) const {
        text(place, value);
        if (value.size() > longest_about)
            fail(place, fmt::format("has {} bytes", value.size()), fmt::format("give at most {} bytes", longest_about));
        if (first_unprintable(value) != std::string::npos)
            fail(place, "contains control characters", "use printable characters and line breaks");
    }
    void text(const std::string& place, const std::string& value) const {
        if (first_invalid_utf8(value) != std::string::npos) fail(place, "is not UTF-8", "encode it as UTF-8");
    }

  private:
    const std::string& file_;
};

/// Which mass properties a body may have.
enum class BodyRole {
    single,     ///< the only body of a scene: mass and principal moments > 0
    mechanism,  ///< one of several bodies: mass and principal moments >= 0; a massless body has no moments
};

/// Checks the mass properties at a place such as "/body". For several bodies, whether every motion has inertia
/// depends on the joints: Tree (motion/tree.h) checks it at the start.
void check_body(const SceneCheck& check, const std::string& place, const Body& body, BodyRole role = BodyRole::single);

/// Checks an initial state at a place such as "/initial".
void check_initial(const SceneCheck& check, const std::string& place, const Initial& initial);

/// Checks several bodies: names, joints, loops and loads.
void check_mechanism(const SceneCheck& check, const Scene& scene);

/// Checks that the loads of a scene of one body name no bodies.
void check_single_body_names(const SceneCheck& check, const Scene& scene);

}  // namespace polhode
