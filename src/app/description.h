// What the descriptions of scenes are written with.
#pragma once

#include <fmt/format.h>

#include <string>

#include "body/algebra.h"
#include "motion/problem.h"
#include "scene/scene.h"
#include "text/decimal.h"

namespace polhode::description {

inline std::string number(double value) { return shortest_decimal(value); }
inline std::string text(const Vector3<double>& v) {
    return fmt::format("({}, {}, {})", number(v[0]), number(v[1]), number(v[2]));
}
inline std::string text(const Quaternion<double>& q) {
    return fmt::format("({}, {}, {}, {})", number(q.w), number(q.x), number(q.y), number(q.z));
}
inline std::string text(const Matrix3<double>& m) {
    if (m == diagonal(Vector3<double>(m[0][0], m[1][1], m[2][2])))
        return "diagonal " + text(Vector3<double>(m[0][0], m[1][1], m[2][2]));
    return fmt::format("{}, {}, {}", text(m[0]), text(m[1]), text(m[2]));
}
inline std::string text(Frame frame) { return frame == Frame::body ? "body" : "world"; }

// A titled block; entries of two columns.
class Report {
  public:
    void title(const std::string& words) { text_ += (text_.empty() ? "" : "\n") + words + "\n"; }
    void line(const std::string& name, const std::string& value) {
        text_ += fmt::format("  {:<26}  {}\n", name, value);
    }
    void line(const std::string& words) { text_ += "  " + words + "\n"; }
    const std::string& text() const { return text_; }

  private:
    std::string text_;
};

/// A block of the loads.
void loads(Report& report, const Scene& scene);
/// A block of the method that auto takes.
void choice(Report& report, const Problem& problem);
/// A block of what the motion keeps.
void invariants(Report& report, const Problem& problem);
/// How much of a scene's conditioning is computed.
enum class ConditioningBudget {
    brief,  ///< what a fixed number of steps reaches: a fraction of a second
    whole,  ///< the whole run, however long that takes
};
/// A block of how small changes of the start grow, and so from when on an engine's error says nothing about the engine.
void growth(Report& report, const Problem& problem, ConditioningBudget budget);
/// All that there is to say of a scene of several bodies between its title and its conditioning.
void mechanism(Report& report, const Problem& problem);

}  // namespace polhode::description
