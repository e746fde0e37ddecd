// Surface integrals of MJCF's primitives, for shellinertia.
#include <cmath>
#include <variant>

#include "scene/mjcf_mass.h"

namespace polhode {
namespace {

Extent<Wide> centred(const Wide& area, const Wide& x, const Wide& y, const Wide& z) {
    return {area, {}, diagonal(Vector3<Wide>(x, y, z))};
}

// Means of x^2, y^2 and z^2 over the surface: area-weighted sums over its parts.
struct ShellOf {
    const Wide pi = Elementary<Wide>::pi();

    Extent<Wide> operator()(const SolidSphere& s) const {
        const Wide r(s.radius), square = r * r / Wide(3);
        return centred(Wide(4) * pi * r * r, square, square, square);
    }
    Extent<Wide> operator()(const Capsule& s) const {
        // tube and sphere, in units of 4 pi r; on a hemisphere z - h is uniform in [0, r]
        const Wide r(s.radius), h(s.half_height), whole = h + r;
        const Wide across = (h * r * r / Wide(2) + r * r * r / Wide(3)) / whole;
        const Wide along = (h * h * h / Wide(3) + r * (h * h + h * r + r * r / Wide(3))) / whole;
        return centred(Wide(4) * pi * r * whole, across, across, along);
    }
    Extent<Wide> operator()(const Cylinder& s) const {
        // tube and two discs, in units of 2 pi r
        const Wide r(s.radius), h(s.half_height), tube = Wide(2) * h, whole = tube + r;
        const Wide across = (tube * r * r / Wide(2) + r * r * r / Wide(4)) / whole;
        const Wide along = (tube * h * h / Wide(3) + r * h * h) / whole;
        return centred(Wide(2) * pi * r * whole, across, across, along);
    }
    Extent<Wide> operator()(const Box& s) const {
        const Vector3<Wide> a = cast<Wide>(s.half_extents);
        const Vector3<Wide> faces(a[1] * a[2], a[2] * a[0], a[0] * a[1]);  // area / 8 of each pair of faces
        const Wide whole = faces[0] + faces[1] + faces[2];
        Vector3<Wide> mean;
        for (int i = 0; i < 3; ++i) mean[i] = a[i] * a[i] * (faces[i] + (whole - faces[i]) / Wide(3)) / whole;
        return centred(Wide(8) * whole, mean[0], mean[1], mean[2]);
    }
    // MuJoCo's approximations: Thomsen's formula for the area, and the solid between the ellipsoid and one with
    // semi-axes longer by 1e-6 m
    Extent<Wide> operator()(const Ellipsoid& s) const {
        constexpr double p = 1.6075;
        const Vector3<double>& a = s.semi_axes;
        const double sum = std::pow(a[0] * a[1], p) + std::pow(a[1] * a[2], p) + std::pow(a[2] * a[0], p);
        const Vector3<Wide> in = cast<Wide>(a);
        Vector3<Wide> out = in;
        for (int i = 0; i < 3; ++i) out[i] = out[i] + Wide(1e-6);
        const Wide inner = in[0] * in[1] * in[2], outer = out[0] * out[1] * out[2];
        Vector3<Wide> mean;
        for (int i = 0; i < 3; ++i)
            mean[i] = (outer * out[i] * out[i] - inner * in[i] * in[i]) / (Wide(5) * (outer - inner));
        return centred(Wide(4) * pi * Wide(std::pow(sum / 3, 1 / p)), mean[0], mean[1], mean[2]);
    }
    template <class Other>
    Extent<Wide> operator()(const Other&) const {
        return {};
    }
};

}  // namespace

Extent<Wide> mjcf_shell(const Shape& shape) { return std::visit(ShellOf{}, shape); }

}  // namespace polhode
