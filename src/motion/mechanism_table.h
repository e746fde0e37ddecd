// The columns and rows of a table from which an ensemble of mechanisms starts: numbers of the scene by their names.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace polhode {

/// What a column of such a table sets: a number of the scene.
struct MechanismColumn {
    std::string name;                       ///< "shoulder.angle", "base.px", ..
    std::string block;                      ///< columns that stand together; its own name of one that stands alone
    std::function<double&(Scene&)> number;  ///< where it goes
    std::function<void(Scene&)> prepare;    ///< called once before, where there is something to do
    bool is_start = true;                   ///< how the motion starts, not what it is the motion of
};

/// All columns that a scene of several bodies has. Of a joint J: `J.angle,J.rate` (revolute), `J.displacement,J.speed`
/// (prismatic), `J.angle1,J.angle2,J.rate1,J.rate2` (universal); `J.qw,J.qx,J.qy,J.qz` and `J.wx,J.wy,J.wz`
/// (spherical: its orientation, and the child's angular velocity against the parent, child axes); of one coordinate
/// also `J.stiffness,J.rest,J.damping`. Of a body B `B.mass`, the tensor staying as it is; of a free base further
/// `B.qw,..`, `B.wx,..`, `B.px,..`, `B.vx,..` as in the table of one body.
std::vector<MechanismColumn> mechanism_columns(const Scene& scene);

/// The scene with a number in place of each column's own.
Scene scene_with(const Scene& scene, const std::vector<MechanismColumn>& columns, std::span<const double> numbers);

/// Rows of such a table.
struct MechanismTable {
    std::vector<MechanismColumn> columns;  ///< those that it has, in its order, without id
    std::vector<double> numbers;           ///< row by row

    /// How many rows there are.
    std::size_t rows() const { return columns.empty() ? 0 : numbers.size() / columns.size(); }
    /// Whether all rows are motions of the same mechanism.
    bool only_starts() const;
    /// The scene of a row, k < rows().
    Scene scene_of(const Scene& scene, std::size_t k) const;
};

}  // namespace polhode
