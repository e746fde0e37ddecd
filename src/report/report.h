// One page of all that a folder of results tells: `polhode report`.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "check/convention.h"

namespace polhode {

/// What a page is to be made of.
struct ReportRequest {
    std::string directory;                  ///< a folder that `polhode run` has written
    std::string output;                     ///< of the page; empty: report.html in that folder
    std::string against;                    ///< a second folder to compare with, or empty
    std::vector<std::string> trajectories;  ///< files of the user's own, to be judged and drawn
    std::string scene;                      ///< theirs; empty: the only one of the folder, or the one named as the file
    Convention convention;                  ///< theirs
    bool motions = true;                    ///< false: nothing is solved, and nothing moves
    int jobs = 1;                           ///< threads
};

/// What was written.
struct ReportMade {
    std::string path;
    std::size_t bytes = 0;
    std::vector<std::string> remarks;  ///< what the page leaves out, a sentence each
};

/// A page is never larger.
inline constexpr std::size_t largest_page = 5'000'000;

/// Writes the page. Throws InputError where a folder, a scene or a trajectory is at fault, std::runtime_error where the
/// page cannot be made or written.
ReportMade write_report_page(const ReportRequest& request);

}  // namespace polhode
