// The folder of published results contains only CSV tables and the pages and figures that a page links to.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <string>

#include "places.h"

namespace polhode {
namespace {

namespace fs = std::filesystem;

std::string content(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {});
}

// names of files in results/ that a page links to or takes excerpts from
std::set<std::string> names_on_pages() {
    const fs::path top = source_dir();
    std::set<std::string> names;
    const auto read = [&](const fs::path& page, const std::regex& link) {
        const std::string text = content(page);
        for (std::sregex_iterator it(text.begin(), text.end(), link); it != std::sregex_iterator(); ++it)
            names.insert(fs::path((*it)[1].str()).filename().string());
    };
    const std::regex link(R"(([A-Za-z0-9_./]+\.(?:md|svg|csv)))");
    read(top / "README.md", link);
    for (const char* folder : {"results", "experiments", "integrators", "src", "tests"})
        for (const auto& entry : fs::recursive_directory_iterator(top / folder))
            if (entry.path().extension() == ".md" && entry.path().string().find("node_modules") == std::string::npos)
                read(entry.path(), link);
    const std::string fill = content(top / "experiments" / "update_readme");
    const std::regex excerpt(R"(excerpt ([a-z0-9_]+))");
    for (std::sregex_iterator it(fill.begin(), fill.end(), excerpt); it != std::sregex_iterator(); ++it)
        names.insert((*it)[1].str() + ".md");
    read(top / "experiments" / "update_readme", link);
    return names;
}

TEST(Results, ContainTheNumbersOfThePages) {
    const std::set<std::string> names = names_on_pages();
    std::set<std::string> others{"scenes.json", ".cases"};
    std::ifstream ignored(source_dir() + "/.gitignore");
    for (std::string line; std::getline(ignored, line);)
        if (line.starts_with("/results/")) others.insert(line.substr(9));
    std::uintmax_t bytes = 0;
    int files = 0;
    for (const auto& entry : fs::directory_iterator(source_dir() + "/results")) {
        const std::string name = entry.path().filename().string(), ending = entry.path().extension().string();
        if (others.contains(name)) continue;
        ++files, bytes += entry.file_size();
        const bool is_record = name == "provenance.json" || name == "reliability.json";
        EXPECT_TRUE(is_record || ending == ".csv" || ending == ".md" || ending == ".svg" || ending == ".png" ||
                    ending == ".gif")
            << name;
        if (ending == ".md" || ending == ".svg") {
            EXPECT_TRUE(names.contains(name)) << name << " is shown by no page";
        }
    }
    EXPECT_GT(files, 50);
    EXPECT_LT(files, 150);
    EXPECT_LT(bytes, 20'000'000U);
}

}  // namespace
}  // namespace polhode
