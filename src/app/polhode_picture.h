// Pictures of a polhode: in 3D by gnuplot, and in a page of text.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "app/polhode_curve.h"

namespace polhode {

/// The gnuplot script that draws the polhode on its ellipsoid, seen from a corner, by `terminal` ("svg" or "pdf") to
/// standard output. `title` shows literally.
std::string polhode_script(const PolhodeCurve& polhode, const std::string& title, const std::string& terminal);

/// Draws it to a path that ends in .svg or .pdf. Returns an empty string, or what went wrong.
std::string draw_polhode(const PolhodeCurve& polhode, const std::string& title, const std::string& path,
                         std::chrono::milliseconds time_limit = std::chrono::seconds(60));

/// Lines of text (UTF-8, Braille patterns as dots): two views, along the axes of the largest and of the middle moment.
/// The curve is solid in front and dotted behind, the ellipsoid's outline sparse, `o` the start.
std::vector<std::string> polhode_text(const PolhodeCurve& polhode);

}  // namespace polhode
