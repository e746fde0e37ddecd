// Reduces motions to keyframes for the interpolation that the page uses.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "motion/trajectory.h"
#include "report/json_numbers.h"

namespace polhode {

/// Sampled motion of one or more bodies: samples[k * bodies + b] is body b at t[k]. Quaternions have unit length, and
/// their sign is such that successive quaternions of a body are on the same hemisphere.
struct SampledMotion {
    int bodies = 1;
    std::vector<double> t;  ///< s, ascending
    std::vector<Sample> samples;

    const Sample& at(std::size_t k, int body) const {
        return samples[k * static_cast<std::size_t>(bodies) + static_cast<std::size_t>(body)];
    }
};

/// Whether all values of the sample are finite and not too large to draw.
bool is_drawable(const Sample& sample);

/// The trajectory up to its first sample that is not drawable.
SampledMotion sampled_motion(const Trajectory& trajectory);

/// Tolerance of the interpolation.
struct Tolerance {
    double angle = 0;   ///< rad
    double length = 0;  ///< m
};

/// Keyframes of a motion.
struct Keyframes {
    std::vector<std::size_t> at;  ///< indices into SampledMotion::t
    Tolerance off;                ///< largest errors of the interpolation at the samples, including rounding
};

/// Selects few samples such that the interpolation between them is within the tolerance of all other samples. Attitudes
/// are interpolated by the cubic Hermite polynomial of the quaternion components with q' = q (0, w_B) / 2 at both ends,
/// then normalised; centres of mass by that of p and v. The interpolation uses the rounded values of the document. If
/// `checked`, only every other sample can become a keyframe, so that every interval contains a sample to check.
Keyframes select_keyframes(const SampledMotion& motion, const Tolerance& tolerance, bool checked);

/// The keyframes as Track of src/report/page/source/data.ts.
Json track_json(const SampledMotion& motion, const Keyframes& keyframes);

/// Interpolated attitude at the fraction `part` (0..1) of the interval between two samples.
Quaternion<double> attitude_between(const Sample& from, const Sample& to, double part);
/// Interpolated centre of mass at the fraction `part` (0..1) of the interval between two samples.
Vector3<double> position_between(const Sample& from, const Sample& to, double part);

}  // namespace polhode
