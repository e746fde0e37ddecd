// Tables of initial states and parameters from which ensembles of mechanisms are solved.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "motion/ensemble_table.h"
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

/// The contents of a table. Columns that it does not have keep the scene's values.
struct MechanismTable {
    std::vector<MechanismColumn> columns;  ///< the table's columns in order, without id
    std::vector<double> numbers;           ///< row by row
    std::vector<std::string> ids;          ///< the column `id`, unchanged; empty if there is none
    std::vector<std::size_t> row_numbers;  ///< number of each row, counted from 1 including refused rows
    std::vector<RefusedRow> refused;       ///< in file order

    std::size_t rows() const { return row_numbers.size(); }
    /// Whether all rows are motions of the same mechanism.
    bool only_starts() const;
    /// The scene of row k < rows().
    Scene scene_of(const Scene& scene, std::size_t k) const;
};

/// Parses a table: a header, then one line per mechanism, with columns by name in any order. Faults are those of
/// ensemble tables (motion/ensemble_table.h). A row whose scene breaks a rule (see validate) is refused; the others
/// are read. Does not check whether loops close. Throws InputError, also if no row is left.
MechanismTable parse_mechanism_table(std::string_view text, const std::string& file, const Scene& scene);

/// Reads and parses a file of at most 4 GiB. Throws InputError, also if it cannot be read.
MechanismTable read_mechanism_table(const std::string& path, const Scene& scene);

}  // namespace polhode
