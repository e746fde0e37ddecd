// Parallel projection of a polhode and its ellipsoid, with visible and hidden parts.
#pragma once

#include <vector>

#include "app/polhode_curve.h"

namespace polhode {

struct PagePoint {
    double x = 0, y = 0;  ///< right and up, in units of the longest semi-axis
};

/// Parts of a line in front of or on the ellipsoid, and parts behind or inside it.
struct VisibleLine {
    std::vector<std::vector<PagePoint>> front, behind;
};

/// Returns the lengths at which the semi-axes are drawn; the longest is 1. They are to scale unless the longest exceeds
/// three times the shortest. Otherwise they are powers of the true lengths with a ratio of 3.
Vector3<double> drawn_semi_axes(const Vector3<double>& semi_axes);

class PolhodeView {
  public:
    /// The view from the direction `toward`, with `right` pointing right. Both are orthogonal unit vectors of the
    /// drawing.
    PolhodeView(const PolhodeCurve& polhode, const Vector3<double>& toward, const Vector3<double>& right);

    /// Projects an angular velocity (rad/s, principal axes) to the page.
    PagePoint at(const Vector3<double>& rate) const;
    bool hidden(const Vector3<double>& rate) const;
    VisibleLine seen(const Polyline& line) const;
    /// Returns the closed outline of the ellipsoid on the page.
    std::vector<PagePoint> outline() const;
    /// Returns parallels and meridians about axis 3 and the principal sections, as angular velocities.
    std::vector<Polyline> wires() const;

    const Vector3<double>& drawn() const { return drawn_; }

  private:
    Vector3<double> on_sphere(const Vector3<double>& rate) const;  ///< maps the ellipsoid to the unit sphere

    Vector3<double> semi_axes_, drawn_, toward_, right_, up_;
};

}  // namespace polhode
