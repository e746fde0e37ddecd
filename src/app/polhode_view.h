// A polhode and its ellipsoid looked at from far away: what is in front, what is behind.
#pragma once

#include <vector>

#include "app/polhode_curve.h"

namespace polhode {

struct PagePoint {
    double x = 0, y = 0;  ///< to the right and up; the longest semi-axis is 1
};

/// Parts of a line that are in front of the ellipsoid, or on it, and those that are behind it or inside.
struct SeenLine {
    std::vector<std::vector<PagePoint>> front, behind;
};

/// The sizes that the semi-axes are drawn with, the longest 1. True to scale unless the longest is more than three
/// times the shortest; then drawn as powers of the true ones, three to one.
Vector3<double> drawn_semi_axes(const Vector3<double>& semi_axes);

class PolhodeView {
  public:
    /// Looked at from the direction `toward`, with `right` to the right: orthogonal unit vectors of the drawing.
    PolhodeView(const PolhodeCurve& polhode, const Vector3<double>& toward, const Vector3<double>& right);

    /// A rate (rad/s, principal axes) on the page.
    PagePoint at(const Vector3<double>& rate) const;
    bool hidden(const Vector3<double>& rate) const;
    SeenLine seen(const Polyline& line) const;
    /// The ellipsoid's outline on the page, closed.
    std::vector<PagePoint> outline() const;
    /// Parallels and meridians about axis 3 and the principal sections, as rates.
    std::vector<Polyline> wires() const;

    const Vector3<double>& drawn() const { return drawn_; }

  private:
    Vector3<double> on_sphere(const Vector3<double>& rate) const;  ///< the ellipsoid becomes the unit sphere

    Vector3<double> semi_axes_, drawn_, toward_, right_, up_;
};

}  // namespace polhode
