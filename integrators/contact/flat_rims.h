// Discs of a hull that are parallel to a plane.
//
// With m = A^T n, the height of a disc's lowest point contains |m| (contact_point.h), which is not smooth where m = 0:
// there the whole rim is lowest. Motions that start with such an attitude are common, and in a motion about a fixed
// horizontal axis m passes through zero. While a disc is parallel to a plane, the driver replaces it by its centre:
//   - If it stays parallel, the height of the centre is that of the rim. The rim is then a face (ContactDriver).
//   - If it does not, the step is limited so that the gap cannot close.
// Steps end where m passes through zero, because the square root of m . m would continue with the wrong sign.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "motion/contact.h"

namespace polhode::contact {

/// The discs of a hull. A disc is a piece { c + A u + r b } (body/support.h) whose A has a rank below 3.
template <class P>
class FlatRims {
  public:
    struct Rim {
        std::size_t piece = 0;
        Matrix3<P> axes;  ///< A, in columns, m
        P radius{0};      ///< m
    };

    explicit FlatRims(const ContactGeometry<P>& geometry) {
        for (std::size_t i = 0; i < geometry.pieces.size(); ++i) {
            const SupportPiece<P>& piece = geometry.pieces[i];
            if (!piece.extended) continue;
            const Matrix3<P> columns = transposed(piece.semi_axes);
            P radius(0);
            for (std::size_t k = 0; k < 3; ++k) radius = std::max(radius, length(columns[k]));
            // an ellipsoid with three axes is smooth
            const P volume = dot(columns[0], cross(columns[1], columns[2]));
            if (Elementary<P>::magnitude(volume) > P(small) * radius * radius * radius) continue;
            rims_.push_back({i, piece.semi_axes, radius});
        }
    }

    bool any() const { return !rims_.empty(); }
    const std::vector<Rim>& all() const { return rims_; }
    /// The rim of a piece, if the piece is parallel to the plane.
    const Rim* flat(const ContactGeometry<P>& geometry, std::size_t plane, std::size_t piece,
                    const Quaternion<P>& q) const {
        for (const Rim& rim : rims_)
            if (rim.piece == piece && is_parallel(rim, tilt(rim, geometry.planes[plane].normal_W, q))) return &rim;
        return nullptr;
    }
    /// m = A^T n at an attitude.
    static Vector3<P> tilt(const Rim& rim, const Vector3<P>& normal_W, const Quaternion<P>& q) {
        return transposed(rim.axes) * rotate_back(q, normal_W);
    }
    /// Replaces discs that are parallel to a plane by their centres, and others by themselves. Returns whether one has
    /// changed.
    bool update(ContactGeometry<P>& geometry, const Quaternion<P>& q) const {
        bool changed = false;
        for (const Rim& rim : rims_) {
            bool parallel = false;
            for (const ContactPlane<P>& plane : geometry.planes)
                parallel = parallel || is_parallel(rim, tilt(rim, plane.normal_W, q));
            bool& extended = geometry.pieces[rim.piece].extended;
            changed = changed || extended == parallel;
            extended = !parallel;
        }
        return changed;
    }
    /// Whether the inclination of a disc differs at two attitudes.
    static bool has_tilted(const Rim& rim, const Vector3<P>& before, const Vector3<P>& after) {
        return length(after - before) > P(small) * rim.radius;
    }
    /// Whether the inclination changes along itself, so that it may pass through zero.
    static bool is_planar(const Vector3<P>& tilt, const Vector3<P>& rate) {
        return !(length(cross(tilt, rate)) > P(small) * length(tilt) * length(rate));
    }

    /// Whether a disc with the inclination m is parallel to the plane.
    static bool is_parallel(const Rim& rim, const Vector3<P>& tilt) { return !(length(tilt) > P(small) * rim.radius); }

  private:
    // smaller inclinations (rad) are zero
    static constexpr double small = 1e-12;
    std::vector<Rim> rims_;
};

}  // namespace polhode::contact
