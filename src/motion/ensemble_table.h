// Bodies or mechanisms by the row: the table that an ensemble starts from.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "body/algebra.h"
#include "motion/mechanism_table.h"
#include "scene/scene.h"

namespace polhode {

/// One body of an ensemble: what it is and how it starts.
struct EnsembleBody {
    double mass = 1;                   ///< kg
    Matrix3<double> inertia_B;         ///< kg m^2, about the centre of mass, off-diagonal entries -int xy dm
    Quaternion<double> orientation;    ///< body to world; stands for its normalised value
    Vector3<double> angular_velocity;  ///< rad/s, in the scene's angular_velocity_frame
    Vector3<double> position_W;        ///< centre of mass, m; zero with a pivot
    Vector3<double> velocity_W;        ///< centre of mass, m/s; zero with a pivot

    /// Whether all numbers are equal.
    bool operator==(const EnsembleBody&) const = default;
};

/// The scene's own body and start, as a row of an ensemble.
EnsembleBody ensemble_body(const Scene& scene);

/// What makes a body impossible: the columns at fault, what is wrong and what would be right.
struct BodyFault {
    std::string columns;  ///< those at fault, "qw,qx,qy,qz"
    std::string fault;    ///< what is wrong
    std::string remedy;   ///< what would be right
};

/// What is wrong with one row by the rules of a scene's body and start (see validate), or nothing. `pivoted` says that
/// the scene holds a point of the body.
std::optional<BodyFault> fault_of(const EnsembleBody& body, bool pivoted);

/// A row that was refused, and why.
struct RefusedRow {
    std::size_t row = 0;  ///< counted from 1, the refused ones too
    std::string fault;    ///< "FILE: line 3, column mass: FAULT; REMEDY"
};

/// The rows of a table, or some of them. Columns that the table lacks have the scene's values.
struct EnsembleTable {
    std::vector<EnsembleBody> bodies;  ///< for scenes of one body, else empty
    std::vector<std::string> ids;      ///< the column `id`; empty without it
    std::vector<RefusedRow> refused;   ///< in the file's order; empty if the first such row ends the reading
    MechanismTable mechanisms;         ///< for scenes of several bodies, else empty

    /// How many rows were not refused.
    std::size_t rows() const { return bodies.size() + mechanisms.rows(); }
    /// The numbers in the whole table of the rows that were not refused; `first` is that of the first row here.
    std::vector<std::size_t> row_numbers(std::size_t first) const;
};

/// What to do about a row with a fault: throw, or list it among the refused and read on.
enum class BadRows { refuse_all, pass_over };

/// Reads a table: a header, then one row per line; columns by name, in any order. For a scene of several bodies see
/// mechanism_columns(). For one body at least one of
///   qw,qx,qy,qz   wx,wy,wz   px,py,pz   vx,vy,vz   ixx,iyy,izz   ixy,ixz,iyz   mass   id
/// q, w, p, v and the moments in whole blocks; products of inertia beside moments only. Without products a row's
/// moments are those about its body axes. w is in the scene's angular_velocity_frame (the body's own axes unless the
/// scene says "world"). Numbers, comments, line ends and faults as in trajectory files (motion/trajectory_csv.h); an id
/// is any text without a comma, of at most 200 bytes. A row that breaks a rule of scenes (see fault_of and validate) is
/// refused; whether loops close is not checked. Throws InputError ("FILE: line 3, column mass: FAULT; REMEDY"); where
/// bad rows are passed over, only if there is no other.
EnsembleTable parse_ensemble(std::string_view text, const std::string& file, const Scene& scene,
                             BadRows bad = BadRows::refuse_all);

}  // namespace polhode
