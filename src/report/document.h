// The document that the page shows, as JSON.
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

/// How much of a folder goes into the page.
struct Detail {
    std::size_t rows = 100'000;     ///< of sweeps; beyond it curves are thinned
    int digits = 5;                 ///< significant, of errors and times
    std::size_t table_rows = 2000;  ///< of each other table
    std::size_t series = 2000;      ///< runs with errors over time
    std::size_t series_points = 200;
    std::size_t tracks = 100'000;  ///< methods' motions of their own; beyond it errors alone are told
};

/// Everything that a page is made of.
struct ReportContent {
    const ResultFolder& folder;
    const std::map<std::string, Scene>& scenes;
    const Motions& motions;
    const Json& checks;                            ///< Check[] of src/report/page/source/data.ts
    const ResultFolder* other = nullptr;           ///< that it is compared with
    const FolderComparison* comparison = nullptr;  ///< where there is one
};

/// ReportData of src/report/page/source/data.ts.
Json report_document(const ReportContent& content, const Detail& detail);

}  // namespace polhode
