// Joint coordinates over a whole run, with the number of full revolutions of each angle.
//
// The motions of the bodies determine an angle only up to full revolutions. Between two samples an angle can be
// followed if it changes by less than half a revolution more or less than its rates predict. If bodies rotate further
// between samples, the run is repeated with more samples, which are used only to count revolutions.
#pragma once

#include <string>
#include <vector>

#include "body/wide.h"
#include "integrators/method.h"
#include "motion/joint_motion.h"

namespace polhode {

/// The motions of all joints at the samples of a run: at each time one per joint, in the scene's order.
template <class P>
struct JointHistory {
    std::vector<double> times;            ///< s
    std::vector<JointMotion<P>> motions;  ///< by time, then by joint
    std::string fault;                    ///< why revolutions could not be counted; empty if they could
};

/// The joints of a trajectory of several bodies. `settings`: those of the run. Without a method, for a trajectory
/// that was not computed here, revolutions are counted from sample to sample.
JointHistory<double> joint_history(const Problem& problem, const Method* method, const Settings& settings,
                                   const Trajectory& trajectory);

/// The joints of the reference of a scene of several bodies.
JointHistory<Wide> joint_history(const Scene& scene, const Reference& truth);

/// Largest number of digits of true joint motions, which are computed from 106 bits.
inline constexpr int most_joint_digits = 28;

/// A number in scientific notation, rounded to `digits` significant digits, at most 32.
std::string wide_decimal(Wide value, int digits);

}  // namespace polhode
