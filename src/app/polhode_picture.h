// Figures of a polhode: in 3D with gnuplot, and as text.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "app/polhode_curve.h"

namespace polhode {

/// Returns the gnuplot script that draws the polhode on its ellipsoid in an oblique view with `terminal` ("svg" or
/// "pdf") to standard output. `title` is shown literally.
std::string polhode_script(const PolhodeCurve& polhode, const std::string& title, const std::string& terminal);

/// Draws the polhode to a path that ends in .svg or .pdf. Returns an empty string, or the error.
std::string draw_polhode(const PolhodeCurve& polhode, const std::string& title, const std::string& path,
                         std::chrono::milliseconds time_limit = std::chrono::seconds(60));

/// Returns lines of text (UTF-8, Braille patterns as dots): two views, along the axes of the largest and of the middle
/// moment. The curve is solid in front and dotted behind, the outline of the ellipsoid is sparse, and `o` is the start.
std::vector<std::string> polhode_text(const PolhodeCurve& polhode);

}  // namespace polhode
