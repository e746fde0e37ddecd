// The same mechanism by the row: the table of other starts that an ensemble of several bodies is solved from.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "motion/ensemble_table.h"
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

/// What a table says. Columns that it lacks are the scene's.
struct MechanismTable {
    std::vector<MechanismColumn> columns;  ///< those that it has, in its order, without id
    std::vector<double> numbers;           ///< row by row
    std::vector<std::string> ids;          ///< of the column `id`, as they stand; empty without it
    std::vector<std::size_t> row_numbers;  ///< of each row, counted from 1, the refused ones too
    std::vector<RefusedRow> refused;       ///< in the file's order

    std::size_t rows() const { return row_numbers.size(); }
    /// Whether all rows are motions of the same mechanism.
    bool only_starts() const;
    /// The scene of a row, k < rows().
    Scene scene_of(const Scene& scene, std::size_t k) const;
};

/// Reads a table: a header, then a line a mechanism; columns by name, in any order. Faults as of ensemble tables; a row
/// whose scene breaks a rule (see validate) is refused and stops no other. Whether loops close is not looked at. Throws
/// InputError, also where no row is left.
MechanismTable parse_mechanism_table(std::string_view text, const std::string& file, const Scene& scene);

/// Reads and parses a file of at most 4 GiB. Throws InputError, also when it cannot be read.
MechanismTable read_mechanism_table(const std::string& path, const Scene& scene);

}  // namespace polhode
