// What the columns of an ensemble's table are, in whatever format it stands.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "motion/ensemble_table.h"

namespace polhode {

/// One column that a table may have.
struct EnsembleColumn {
    const char* name;
    void (*put)(EnsembleBody&, double);  ///< sets a body's number; nullptr: the id
    int block;                           ///< columns of one block stand together
};

/// All of them.
const std::vector<EnsembleColumn>& ensemble_columns();

/// What a row begins from that has these columns: the scene's body and start, without its tensor where the table has
/// moments. Throws InputError, `place` being that of the columns' names: blocks that are not whole, products of inertia
/// without moments, no column but id, places or velocities beside a pivot.
EnsembleBody start_under(const std::vector<const EnsembleColumn*>& columns, const Scene& scene, const std::string& file,
                         const std::string& place);

/// What is wrong with an id, or nothing: more than 200 bytes, no UTF-8, quotes or control characters.
std::optional<BodyFault> fault_of_id(std::string_view id);

/// "column mass" or "columns qw,qx,qy,qz": where a fault lies.
std::string place_of(const BodyFault& fault);

}  // namespace polhode
