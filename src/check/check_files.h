// What `polhode check` does with trajectory files: reads, judges, diagnoses and compares them with the floors.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "check/convention.h"
#include "check/foreign_table.h"
#include "check/report.h"
#include "motion/trajectory_csv.h"
#include "scene/scene.h"

namespace polhode {

/// There is no truth to judge a file by; says which file, and why.
struct NoTruth : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// A table that stands in memory, as a file would have it.
struct NamedText {
    std::string name;  ///< what messages call it
    std::string text;  ///< CSV
};

/// A file of more bytes is not read.
inline constexpr std::size_t largest_file = std::size_t{1} << 30;

/// The file of this text in our conventions; what had to be done to it is added to `checked`, whose path messages name.
/// Without a scene (nullptr) it may be of any length and of any bodies. `gaps`: as in parse_foreign_trajectory().
/// Throws InputError.
TrajectoryFile prepared_file(const Scene* scene, const Convention& convention, const ColumnNames& columns,
                             std::string_view text, CheckedFile& checked, std::vector<std::size_t>* gaps = nullptr);

/// Judges the files at these paths against the scene's truth. All are read before any is judged: a slip in the last
/// must not cost the time of the first. `columns`: which of theirs hold ours, if they are not told by their names.
/// Files of more than some thousand samples are judged in binary64, by several threads. `explain`: known faults are
/// tried on sound files too. `picture`: their errors over time are drawn into CheckedFile::picture. Throws InputError
/// where a file cannot be read, or goes on for longer than the scene, and NoTruth, also where it is interrupted.
std::vector<CheckedFile> check_files(const Scene& scene, const std::vector<std::string>& paths,
                                     const Convention& convention, const ColumnNames& columns,
                                     const ErrorLimits& limits, bool explain, bool picture = false);
/// The same of tables that stand in memory.
std::vector<CheckedFile> check_files(const Scene& scene, const std::vector<NamedText>& texts,
                                     const Convention& convention, const ColumnNames& columns,
                                     const ErrorLimits& limits, bool explain, bool picture = false);

}  // namespace polhode
