// The steps of `polhode check`: read trajectory files, compare them with the truth and the floors, diagnose them.
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

/// No truth is available for a file. The message has the file and the reason.
struct TruthUnavailable : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// A CSV table in memory.
struct NamedText {
    std::string name;  ///< name used in messages
    std::string text;  ///< CSV
};

/// Size limit of a file, bytes.
inline constexpr std::size_t largest_file = std::size_t{1} << 30;

/// Parses `text` and converts it to polhode's conventions. Adds remarks on the conversion to `checked`; error
/// messages use the path of `checked`. Without a scene (nullptr), any duration and any bodies are accepted. `gaps`:
/// see parse_foreign_trajectory(). Throws InputError.
TrajectoryFile prepare_file(const Scene* scene, const Convention& convention, const ColumnNames& columns,
                            std::string_view text, CheckedFile& checked, std::vector<std::size_t>* gaps = nullptr);

/// Compares the files at these paths with the scene's truth. All files are read first, so that an error in the last
/// one is found at once. `columns`: which columns hold polhode's, if their names do not show it. Files of more than
/// 2000 samples are evaluated in binary64, with several threads. `explain`: test known faults on sound files too.
/// `picture`: draw the errors over time into CheckedFile::picture. Throws InputError if a file cannot be read or
/// lasts longer than the scene. Throws TruthUnavailable if there is no truth or the run is interrupted.
std::vector<CheckedFile> check_files(const Scene& scene, const std::vector<std::string>& paths,
                                     const Convention& convention, const ColumnNames& columns,
                                     const ErrorLimits& limits, bool explain, bool picture = false);
/// Compares CSV tables in memory with the scene's truth, like files.
std::vector<CheckedFile> check_files(const Scene& scene, const std::vector<NamedText>& texts,
                                     const Convention& convention, const ColumnNames& columns,
                                     const ErrorLimits& limits, bool explain, bool picture = false);

}  // namespace polhode
