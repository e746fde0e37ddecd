// Requirements on any results folder given to `polhode report`; see oracles.h.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "fuzz/oracles.h"
#include "report/document.h"
#include "report/findings.h"
#include "report/folder.h"
#include "report/page.h"

namespace polhode::oracles {

/// A private temporary directory, in memory if possible. The destructor removes it.
class OwnDirectory {
  public:
    explicit OwnDirectory(const char* purpose) {
        const std::filesystem::path memory("/dev/shm");
        const auto parent = ::access(memory.c_str(), W_OK) == 0 ? memory : std::filesystem::temp_directory_path();
        std::string pattern = (parent / ("polhode-" + std::string(purpose) + "-XXXXXX")).string();
        require(::mkdtemp(pattern.data()) != nullptr, "cannot make a temporary directory");
        path_ = pattern;
    }
    ~OwnDirectory() {
        std::error_code none;
        std::filesystem::remove_all(path_, none);
    }
    OwnDirectory(const OwnDirectory&) = delete;
    OwnDirectory& operator=(const OwnDirectory&) = delete;

    const std::filesystem::path& path() const { return path_; }
    /// Removes all files.
    void clear() const {
        for (const auto& entry : std::filesystem::directory_iterator(path_)) std::filesystem::remove_all(entry.path());
    }
    void write(const std::string& name, std::string_view text) const {
        std::ofstream(path_ / name, std::ios::binary) << text;
    }

  private:
    std::filesystem::path path_;
};

/// Writes the files in `text`, each after a line "=== NAME". Drops characters of NAME that could leave the folder.
inline void write_files(std::string_view text, const OwnDirectory& directory) {
    std::string name = "t.csv", contents;
    int files = 0;
    while (!text.empty() && files < 8) {
        const std::string_view line = text.substr(0, std::min(text.find('\n'), text.size() - 1) + 1);
        text.remove_prefix(line.size());
        if (!line.starts_with("=== ")) {
            contents += line;
            continue;
        }
        directory.write(name, contents), contents.clear(), ++files;
        name.clear();
        for (const char c : line.substr(4))
            if (std::isalnum(static_cast<unsigned char>(c)) || c == '_' || (c == '.' && !name.empty())) name += c;
        if (name.empty() || name.size() > 40) name = "t.csv";
    }
    directory.write(name, contents);
}

/// A results folder is refused by one line, or all indices of its rows are valid and its report is valid JSON.
inline void folder(std::string_view text) {
    static const OwnDirectory directory("folder");
    directory.clear();
    write_files(text, directory);
    std::optional<ResultFolder> read;
    try {
        read = read_folder(directory.path().string(), 50);
    } catch (const InputError& error) {
        require_one_line(error.what());
        require(std::string_view(error.what()).starts_with(directory.path().string()),
                "the message does not name the folder");
        return;
    }
    for (const std::string& remark : read->remarks) require_one_line(remark);
    const auto inside = [](int place, const NameList& names) {
        return place >= 0 && static_cast<std::size_t>(place) < names.names().size();
    };
    for (const FolderRow& row : read->rows) {
        require(row.experiment >= 0 && static_cast<std::size_t>(row.experiment) < read->experiments.size() &&
                    inside(row.scene, read->scenes) && inside(row.method, read->methods) &&
                    inside(row.message, read->messages) && inside(row.formulation, read->formulations),
                "an index of a row is outside the folder's lists");
    }
    for (const FolderSeries& series : read->series)
        for (const std::vector<double>& errors : series.errors)
            require(errors.size() == series.t.size(), "a series has different numbers of errors and times");
    require(make_findings(*read).size() <= 3, "too many findings");
    const Motions motions;
    const Json checks = Json::array();
    // planning the experiments again to get their scenes is slow
    const std::map<std::string, Scene> scenes = one_in(32, text) ? read_scenes(*read) : std::map<std::string, Scene>();
    const Json document = report_document({*read, scenes, motions, checks}, {1000, 5, 50, 20, 20, 0});
    const std::string dumped = document.dump(-1, ' ', false, Json::error_handler_t::replace);
    require(Json::accept(dumped), "the document is not valid JSON");
    if (one_in(64, text)) {
        const std::string page = fill_page("<!--polhode:title--><!--polhode:data-->", read->name, dumped);
        require(page.find('<') == page.npos, "a folder's name or data is interpreted as a placeholder of the page");
    }
}

}  // namespace polhode::oracles
