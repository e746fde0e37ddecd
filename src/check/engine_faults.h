// What engines do to the equations and to their steps, as hypotheses of check/hypotheses.h explain a file by it.
#pragma once

#include <optional>

#include "check/hypotheses.h"

namespace polhode {

/// The attitude goes on by first-order updates with the file's own w.
std::optional<Explanation> first_order(const ComparedRows& rows);
std::optional<Explanation> without_gyroscopic_term(const ComparedRows& rows);
std::optional<Explanation> reversed_gyroscopic_term(const ComparedRows& rows);
/// |w| is limited after each step.
std::optional<Explanation> clamped_speed(const ComparedRows& rows);
/// A damping of w that the scene has not.
std::optional<Explanation> left_damping(const ComparedRows& rows);
/// The scene's own motion at s times the file's times.
std::optional<Explanation> wrong_time(const ComparedRows& rows);

}  // namespace polhode
