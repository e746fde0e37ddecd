// `polhode report`: writes a result directory as one HTML page.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "check/convention.h"

namespace polhode {

/// Input of a page.
struct ReportRequest {
    std::string directory;                  ///< directory written by `polhode run`
    std::string output;                     ///< path of the page; empty: report.html in the directory
    std::string against;                    ///< second directory to compare with, or empty
    std::vector<std::string> trajectories;  ///< user trajectory files to check and draw
    std::string scene;      ///< scene of the trajectories; empty: named as the first file, or the only scene
    Convention convention;  ///< convention of the trajectory files
    bool motions = true;    ///< solve the scenes and add animated motions
    int jobs = 1;           ///< threads
};

/// The written page.
struct ReportSummary {
    std::string path;
    std::size_t bytes = 0;
    std::vector<std::string> remarks;  ///< one sentence per omission
};

/// Upper limit of a page's size, bytes.
inline constexpr std::size_t largest_page = 5'000'000;

/// Writes a page with only a lesson: a built-in one or a lesson file (report/lessons.h). `output`: path of the page;
/// empty: NAME.html in the working directory, where NAME is the lesson or the stem of its file. Throws InputError for
/// an invalid lesson, and std::runtime_error if the page cannot be created or written.
ReportSummary write_lesson_page(const std::string& lesson, const std::string& output);

/// Writes the page. Throws InputError if a directory, scene or trajectory is invalid, and std::runtime_error if the
/// page cannot be created or written.
ReportSummary write_report_page(const ReportRequest& request);

}  // namespace polhode
