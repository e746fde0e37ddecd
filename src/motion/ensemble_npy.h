// Tables of ensembles in NumPy's binary format.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "motion/ensemble_stream.h"

namespace polhode {

/// Opens a file that numpy.save has written of a one-dimensional structured array, one record per body or mechanism:
/// fields by the names that CSV files have for columns (see parse_ensemble), numbers <f8, the id S1 to S200. As strict
/// as for CSV; a fault names the row, counted from 1, in place of the line. `scene` outlives what is returned. Throws
/// InputError.
std::unique_ptr<EnsembleStream> open_npy_ensemble(const std::string& path, const Scene& scene);

/// Reads an ensemble from a file's content, which must outlive the returned stream.
std::unique_ptr<EnsembleStream> npy_ensemble_of(std::string_view content, const std::string& file, const Scene& scene);

}  // namespace polhode
