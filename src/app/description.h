// Building blocks of the descriptions of scenes.
#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

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

// A text of titled blocks with entries in two columns.
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

/// Appends the block on loads.
void loads(Report& report, const Scene& scene);
/// Appends the block on the method that auto selects.
void choice(Report& report, const Problem& problem);
/// Appends the lines on parameters, definitions and switches of formulas.
void formulas(Report& report, const Problem& problem);
/// Appends the block on invariants of the motion. `without`: the text if no invariant is known.
void invariants(Report& report, const Problem& problem, const char* without);
/// How far the conditioning of a scene is computed.
enum class ConditioningBudget {
    brief,  ///< for a fixed number of steps: a fraction of a second
    whole,  ///< for the whole run, without a time limit
};
/// Appends the block on conditioning: growth of small changes of the initial state, and until when an engine's error
/// can be attributed to the engine. `times`: ascending, s.
void growth(Report& report, const Problem& problem, ConditioningBudget budget, const std::vector<double>& times);
/// Appends the block on contacts with planes: modes over time and events, by a run in binary64.
void contacts(Report& report, const Problem& problem);
/// Appends the blocks of a scene of several bodies, except title and conditioning.
void mechanism(Report& report, const Problem& problem);

}  // namespace polhode::description
