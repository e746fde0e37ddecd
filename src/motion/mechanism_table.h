// The columns and rows of a table from which an ensemble of mechanisms starts: numbers of the scene by their names.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace polhode {

/// A column of the table: it sets one number of the scene.
struct MechanismColumn {
    std::string name;                       ///< "shoulder.angle", "base.px", ..
    std::string block;                      ///< columns that must appear together; its own name if it stands alone
    std::function<double&(Scene&)> number;  ///< the number in the scene that it sets
    std::function<void(Scene&)> prepare;    ///< called once before it is set, if not empty
    bool is_start = true;                   ///< sets the initial state, not a property of the mechanism
};

/// All columns of a scene of several bodies.
///
/// - Joint J, revolute: `J.angle,J.rate`; prismatic: `J.displacement,J.speed`; universal:
///   `J.angle1,J.angle2,J.rate1,J.rate2`; spherical: `J.qw,J.qx,J.qy,J.qz` (orientation) and `J.wx,J.wy,J.wz`
///   (angular velocity of the child relative to the parent, child axes). Joints of one coordinate also have
///   `J.stiffness,J.rest,J.damping`.
/// - Body B: `B.mass` (the inertia tensor is unchanged). A free base also has `B.qw,..`, `B.wx,..`, `B.px,..`,
///   `B.vx,..` as in the table of one body.
std::vector<MechanismColumn> mechanism_columns(const Scene& scene);

/// The scene with a number in place of each column's own.
Scene scene_with(const Scene& scene, const std::vector<MechanismColumn>& columns, std::span<const double> numbers);

/// Rows of a table of mechanisms.
struct MechanismTable {
    std::vector<MechanismColumn> columns;  ///< the table's columns in order, without id
    std::vector<double> numbers;           ///< row by row

    /// How many rows there are.
    std::size_t rows() const { return columns.empty() ? 0 : numbers.size() / columns.size(); }
    /// Whether all rows are motions of the same mechanism.
    bool only_starts() const;
    /// The scene of row k < rows().
    Scene scene_of(const Scene& scene, std::size_t k) const;
};

}  // namespace polhode
