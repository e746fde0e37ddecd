// Catalogues of invalid files: tests/FOLDER/bad/NAME, each with one error, and tests/FOLDER/bad_places.tsv, which
// lists the place that each message must name.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <ostream>
#include <string>
#include <vector>

#include "places.h"

namespace polhode {

struct BadFile {
    std::string path, place;  ///< `place`: the text that the message must contain
};

/// Prints the path. GoogleTest's default prints all bytes, including uninitialised ones of short strings.
inline void PrintTo(const BadFile& bad, std::ostream* out) { *out << bad.path; }

inline std::vector<BadFile> bad_files(const std::string& room, const std::string& ending) {
    const std::string directory = source_dir() + "/tests/" + room;
    std::vector<BadFile> all;
    std::ifstream table(directory + "/bad_places.tsv");
    for (std::string line; std::getline(table, line);) {
        if (line.starts_with('#')) continue;
        const std::size_t tab = line.find('\t');
        std::string path = directory;
        path.append("/bad/").append(line, 0, tab).append(ending);
        all.push_back({path, line.substr(tab + 1)});
    }
    return all;
}

/// Checks that the message is one line of the form FILE: PLACE: FAULT; REMEDY.
inline void expect_one_line(const BadFile& bad, const std::string& message) {
    SCOPED_TRACE(bad.path + "\n" + message);
    ASSERT_FALSE(message.empty()) << "accepted";
    EXPECT_EQ(message.find_first_of(std::string("\n\r\t\0\x7f", 5)), std::string::npos);
    const std::string name = std::filesystem::path(bad.path).filename().string();
    const std::size_t file = message.find(name + ": ");
    ASSERT_NE(file, std::string::npos);
    EXPECT_NE(message.find(bad.place, file + name.size()), std::string::npos) << "wanted: " << bad.place;
    EXPECT_NE(message.find("; ", file), std::string::npos);
    EXPECT_LT(message.size(), 1300u);
}

/// Checks that every file of the catalogue is listed exactly once.
inline void expect_whole_catalogue(const std::string& room, const std::string& ending) {
    std::vector<std::string> listed, there;
    for (const BadFile& bad : bad_files(room, ending)) listed.push_back(bad.path);
    for (const auto& entry : std::filesystem::directory_iterator(source_dir() + "/tests/" + room + "/bad"))
        there.push_back(entry.path().string());
    std::sort(listed.begin(), listed.end());
    std::sort(there.begin(), there.end());
    EXPECT_EQ(listed, there);
}

/// Whether `polhode check` accepts, or refuses for another reason, a trajectory file that the strict reader refuses.
/// `check` accepts other programs' column names and ignores unknown columns with a remark.
inline bool is_read_by_check(const BadFile& bad) {
    for (const char* name : {"/motion/bad/unknown_column.csv", "/motion/bad/column_in_capitals.csv",
                             "/motion/bad/quoted_header.csv", "/motion/bad/duplicate_body.csv"})
        if (bad.path.ends_with(name)) return true;
    // for a scene of one body the error is two rows at the same time
    return bad.path.find("/motion/bad/body_") != std::string::npos;
}

}  // namespace polhode
