// Motions with contact whose result is known in closed form, run by a method at one step: what engines do with
// friction, restitution, rolling and rest.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "integrators/method.h"

namespace polhode {

/// Directions of the sliding ball in the plane, degrees from its x axis.
inline constexpr std::array<double, 7> probe_angles{0, 15, 30, 45, 60, 75, 90};

/// Results at one step. Empty if the method does not support the motion or did not complete it.
struct ContactProbe {
    std::vector<double> friction;     ///< friction of a sliding ball over mu m g at probe_angles, exactly 1
    std::optional<double> deviation;  ///< its largest change of direction, degrees, exactly 0
    std::optional<double> held;       ///< path of a block in 2 s at 0.99 of the critical slope, m, exactly 0
    std::optional<double> slipped;    ///< path of the block at 1.01 of the critical slope, over the exact path
    std::optional<double> pushed;   ///< speed after 1 s of a block pushed diagonally by 1.09 mu m g, over the exact one
    std::optional<double> rolling;  ///< acceleration of a ball on an incline over 5/7 g sin a
    std::optional<double> first_bounce, fifth_bounce;  ///< height after impacts with e = 0.8 over that of the fall
    std::optional<double> drift;                       ///< path of a block at rest on half the critical slope in 5 s, m
    std::optional<double> depth;                       ///< its depth in the plane after 5 s, m
    std::optional<double> slow_path;    ///< path of a ball that rolls with 0.05 m/s for 4 s, over the exact one
    std::optional<double> disc_height;  ///< height of Euler's disc after 1 s over the first one, exactly 1
    std::optional<double> reversal;     ///< time at which the rattleback reverses its spin, s
    bool keeps_spin = false;            ///< the rattleback was followed to its end without a reversal
    std::optional<double> throw_error;  ///< direction of the object ball after a hit, minus the exact one, degrees
    std::string fault;                  ///< why the sliding ball was not followed
};

/// Runs all motions. `step`: s.
ContactProbe probe_contact(const Method& method, double step);

/// Directions of a block's motion from the axes of friction pyramids, degrees.
inline constexpr std::array<double, 7> direction_angles{0, 11.25, 22.5, 33.75, 45, 67.5, 90};

/// A block on a level plane in one direction. A sliding block stops after v^2 / (2 mu g); a block at rest that is
/// pushed with 1.25 mu m g has the speed mu g T / 4 after the time T. Both keep their direction.
struct DirectionProbe {
    std::optional<double> distance;            ///< path to rest over the exact one
    std::optional<double> distance_direction;  ///< direction of this path minus the exact one, degrees
    std::optional<double> pushed;              ///< speed of the pushed block over the exact one
    std::optional<double> pushed_direction;    ///< direction of its path, degrees; empty if it does not move
    std::string fault;                         ///< why a motion was not followed
};

/// One result for each of direction_angles. `settings`: step or tolerance of the method.
std::vector<DirectionProbe> probe_directions(const Method& method, const Settings& settings);

/// The exact height after n impacts, over that of the fall.
double exact_bounce(int impacts);
/// The time at which the rattleback reverses its spin by the method `taylor`, s.
std::optional<double> exact_reversal();

/// "cone", "pyramid, 1.41 at 45 degrees", "no limit: rolls at once", or what else the friction of the sliding ball is.
std::string describe_cone(const ContactProbe& probe);
/// "holds, slips": what the block does at 0.99 and at 1.01 of the critical slope.
std::string describe_hold(const ContactProbe& probe);

}  // namespace polhode
