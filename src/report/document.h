// The page's document as JSON.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "report/comparison.h"
#include "report/folder.h"
#include "report/json_numbers.h"
#include "report/motions.h"

namespace polhode {

/// Limits on the data in the page.
struct Detail {
    std::size_t rows = 100'000;     ///< result rows; beyond this number, curves are thinned
    int digits = 5;                 ///< significant digits of errors and times
    std::size_t table_rows = 2000;  ///< rows of each other table
    std::size_t series = 2000;      ///< runs with errors over time
    std::size_t series_points = 200;
    std::size_t tracks = 100'000;  ///< motions of methods; beyond this number, only errors are kept
    std::size_t curves = 1000;  ///< contacts and joints with curves; beyond this number, only modes and events are kept
};

/// Contents of a page.
struct ReportContent {
    const ResultFolder& folder;
    const std::map<std::string, Scene>& scenes;
    const Motions& motions;
    const Json& checks;                            ///< Check[] of src/report/page/source/data.ts
    const ResultFolder* other = nullptr;           ///< directory to compare with, or null
    const FolderComparison* comparison = nullptr;  ///< comparison with `other`, or null
    Json lessons = Json::array();                  ///< Lesson[] of src/report/page/source/data.ts
    bool lesson_page = false;                      ///< the page has only a lesson
};

/// The contents as ReportData of src/report/page/source/data.ts, reduced to `detail`.
Json report_document(const ReportContent& content, const Detail& detail);

}  // namespace polhode
