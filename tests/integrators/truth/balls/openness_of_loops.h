// A rigorous bound of how far the loops are open in a motion given as decimals.
#pragma once

#include <string>
#include <vector>

#include "integrators/truth/balls/ball.h"
#include "integrators/truth/reference.h"
#include "motion/exact_body.h"
#include "motion/mechanism_motion_of.h"
#include "scene/scene.h"

namespace polhode::truth {
namespace openness {

inline constexpr long bits = 512;

inline Ball exactly(const std::string& decimal) {
    Ball x;
    arb_set_str(x.raw(), decimal.c_str(), bits);
    return x;
}

struct Placed {
    Quaternion<Ball> q;
    Vector3<Ball> origin_W;
};

inline Placed placed(const DecimalColumns& columns, const MassProperties<Ball>& body) {
    const auto number = [&](std::size_t i) { return exactly(columns[i]); };
    const Quaternion<Ball> q = normalized(Quaternion<Ball>{number(0), number(1), number(2), number(3)});
    return {q, Vector3<Ball>(number(7), number(8), number(9)) - rotate(q, body.center)};
}

inline Bound size(const Vector3<Ball>& v) {
    Bound sum;
    for (std::size_t k = 0; k < 3; ++k) sum += Bound(v[k]) * Bound(v[k]);
    return root(sum);
}

inline Vector3<Ball> unit(const Vector3<double>& axis) {
    const Vector3<Ball> a = cast<Ball>(axis);
    return (Ball(1) / length(a)) * a;
}

}  // namespace openness

/// An upper bound over all samples and loops: the distance of a loop's points or the error of a distance (m), and the
/// sine of the angle between the axes of a revolute loop. The decimals are taken as exact, with each q normalised.
inline Bound openness_of_loops(const Scene& scene, const DecimalReference& truth) {
    using namespace openness;
    const WorkingPrecision precision(bits);
    const std::vector<MassProperties<Ball>> bodies = bodies_mass_properties<Ball>(scene);
    const Placed world{{Ball(1), Ball(0), Ball(0), Ball(0)}, {}};
    Bound largest;
    std::vector<Placed> frames(bodies.size());
    for (std::size_t first = 0; first + bodies.size() <= truth.columns.size(); first += bodies.size()) {
        for (std::size_t b = 0; b < bodies.size(); ++b) frames[b] = placed(truth.columns[first + b], bodies[b]);
        const auto frame = [&](const std::string& name) -> const Placed& {
            const int b = body_index(scene, name);
            return b < 0 ? world : frames[static_cast<std::size_t>(b)];
        };
        for (const Loop& loop : scene.loops) {
            const Placed &one = frame(loop.first), &other = frame(loop.second);
            const Vector3<Ball> apart = other.origin_W + rotate(other.q, cast<Ball>(loop.second_point)) -
                                        (one.origin_W + rotate(one.q, cast<Ball>(loop.first_point)));
            Bound open = loop.type == LoopType::distance ? Bound(length(apart) - Ball(loop.length)) : size(apart);
            if (loop.type == LoopType::revolute)
                open += size(cross(rotate(one.q, unit(loop.first_axis)), rotate(other.q, unit(loop.second_axis))));
            if (largest < open) largest = open;
        }
    }
    return largest;
}

}  // namespace polhode::truth
