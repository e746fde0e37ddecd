// The truth's pairs as multiprecision numbers, and the truth of a scene computed with an empty cache.
#pragma once

#include <boost/math/special_functions/ellint_1.hpp>
#include <boost/math/special_functions/jacobi_elliptic.hpp>
#include <cmath>

#include "integrators/series/real.h"
#include "integrators/truth/fresh_cache.h"
#include "integrators/truth/reference.h"
#include "motion/exact_body_of.h"
#include "scene/scene_file.h"

namespace polhode {

using Real100 = Real<100>;

inline Real100 value(const Pair& pair) { return Real100(pair.high) + Real100(pair.low); }
inline Vector3<Real100> value(const Vector3<Pair>& v) { return {value(v[0]), value(v[1]), value(v[2])}; }
inline Quaternion<Real100> value(const Quaternion<Pair>& q) { return {value(q.w), value(q.x), value(q.y), value(q.z)}; }

/// |v|, without overflow of the square.
inline double size(const Vector3<double>& v) { return std::hypot(v[0], v[1], v[2]); }
inline Real100 length(const Vector3<Real100>& v) { return square_root(dot(v, v)); }

/// |a - b|, formed before rounding.
inline double gap(const Real100& a, const Real100& b) { return Real100(abs(Real100(a - b))).convert_to<double>(); }

/// The built-in scene, with a shorter duration if given.
inline Scene shortened(const std::string& name, double duration = 0) {
    Scene scene = find_scene(name);
    if (duration > 0) scene.duration = duration;
    return scene;
}

/// The scene's truth to 25 digits, computed with an empty cache.
inline Reference fresh_truth(const Scene& scene, long samples) {
    const FreshCache cache;
    return reference(scene, samples);
}

}  // namespace polhode
