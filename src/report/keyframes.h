// Motions thinned to keyframes, by the very interpolation that the page draws with.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "motion/trajectory.h"
#include "report/json_numbers.h"

namespace polhode {

/// The motion of some bodies at times: samples[k * bodies + b] at t[k], attitudes of unit length, each on the same side
/// of the quaternions' sphere as the one before.
struct SampledMotion {
    int bodies = 1;
    std::vector<double> t;  ///< s, ascending
    std::vector<Sample> samples;

    const Sample& at(std::size_t k, int body) const {
        return samples[k * static_cast<std::size_t>(bodies) + static_cast<std::size_t>(body)];
    }
};

/// Whether all its numbers are finite and not too large to draw.
bool is_drawable(const Sample& sample);

/// A trajectory as such a motion, up to its first number that is not finite or too large to draw.
SampledMotion sampled_motion(const Trajectory& trajectory);

/// How far interpolation may be off.
struct Tolerance {
    double angle = 0;   ///< rad
    double length = 0;  ///< m
};

/// Keyframes of a motion.
struct Keyframes {
    std::vector<std::size_t> at;  ///< their places among the samples
    Tolerance off;                ///< the largest distances from the samples between them, rounding included
};

/// As few of a motion's samples as are needed to be within the tolerance of all the others. Attitudes between two
/// keyframes: the cubic Hermite polynomial of the quaternion's components with q' = q (0, w_B) / 2 at both ends,
/// normalised; centres of mass: that of p and v. What is interpolated is what stands in the document, rounded.
/// `checked`: only every other sample may become one, so that between any two there is one to check by.
Keyframes thinned(const SampledMotion& motion, const Tolerance& tolerance, bool checked);

/// The keyframes as the page reads them: Track of src/report/page/source/data.ts.
Json track_json(const SampledMotion& motion, const Keyframes& keyframes);

/// The attitude so far (0..1) from one sample to the next one, as above.
Quaternion<double> attitude_between(const Sample& from, const Sample& to, double part);
/// Likewise the centre of mass.
Vector3<double> position_between(const Sample& from, const Sample& to, double part);

}  // namespace polhode
