#include "experiment/run/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include "experiment/run/provenance.h"
#include "text/atomic_file.h"
#include "text/content_hash.h"

namespace polhode {
namespace {

// replaces this experiment's rows of a shared table and keeps those of other experiments
void write_shared(const std::string& experiment, Table table, const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    try {
        const Table old = parse_csv(std::string(std::istreambuf_iterator<char>(file), {}));
        if (old.columns == table.columns)
            for (const auto& row : old.rows)
                if (text_of(row.back()) != experiment) table.rows.push_back(row);
    } catch (const std::invalid_argument&) {
        // missing, or not written by polhode
    }
    std::stable_sort(table.rows.begin(), table.rows.end(),
                     [](const auto& a, const auto& b) { return text_of(a.back()) < text_of(b.back()); });
    write_atomically(path.string(), csv(table));
}

// File names of one report. Scene names may contain any printable characters. File names keep letters, digits, _, -
// and inner dots. Names that are too long end in a hash. Names that differ only in case are numbered, because some file
// systems ignore case.
class FileNames {
  public:
    std::string of(const std::string& whole) {
        if (const auto known = known_.find(whole); known != known_.end()) return known->second;
        std::string name;
        for (const char c : whole) {
            const bool stays = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-' ||
                               (c == '.' && !name.empty() && name.back() != '.');
            name += stays ? c : '_';
        }
        if (name.size() > longest) name = name.substr(0, longest - 17) + "_" + content_hash(whole).substr(0, 16);
        const std::string first = name;
        for (int number = 2; !taken_.insert(lower(name)).second; ++number) name = fmt::format("{}_{}", first, number);
        return known_[whole] = name;
    }

  private:
    static constexpr std::size_t longest = 150;  // bytes, without file extensions and numbers of split figures
    static std::string lower(std::string text) {
        for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
        return text;
    }

    std::map<std::string, std::string> known_;
    std::set<std::string> taken_;
};

}  // namespace

NamedTable make_named_table(std::string name, std::string title, const std::vector<ColumnChoice>& columns) {
    NamedTable named{std::move(name), std::move(title), {}};
    for (const ColumnChoice& column : columns) {
        named.table.columns.push_back(column.column);
        if (!column.heading.empty()) named.page_columns.push_back(column);
    }
    return named;
}

Table page_of(const NamedTable& named) {
    if (named.page) return *named.page;
    return named.page_columns.empty() ? named.table : select(named.table, named.page_columns);
}

std::vector<std::string> write_report(const Plan& plan, const Findings& findings, const std::string& directory,
                                      const std::string& command_line, bool quick, const Formats& formats) {
    const std::string& experiment = plan.experiment.name;
    const std::filesystem::path folder(directory);
    std::filesystem::create_directories(folder);
    FileNames tables, pictures;
    std::vector<std::string> files;
    const auto write = [&](const std::string& name, const std::string& text) {
        write_atomically((folder / name).string(), text);
        files.push_back(name);
    };
    const auto name_of = [&](const NamedTable& named) {
        return tables.of(named.name.empty() ? experiment : experiment + "_" + named.name);
    };
    for (const NamedTable& named : findings.tables) {
        if (named.is_shared) {
            write_shared(experiment, named.table, folder / (named.name + ".csv"));
            continue;
        }
        const std::string name = name_of(named);
        write(name + ".csv", csv(named.table));
        if (named.only_csv) continue;
        const Table page = page_of(named);
        if (formats.has("json")) write(name + ".json", json(named.table));
        if (formats.has("md")) write(name + ".md", markdown(page));
        if (formats.has("tex"))
            write(name + ".tex", latex(page, named.title.empty() ? plan.experiment.about : named.title, "tab:" + name));
    }
    if (!findings.page.empty() && formats.has("md")) write(experiment + ".md", findings.page);
    std::vector<std::string> remarks;
    std::vector<std::string> picture_formats;
    for (const char* name : {"svg", "pdf"})
        if (formats.has(name)) picture_formats.emplace_back(name);
    for (const NamedFigure& whole : findings.figures)
        for (const NamedFigure& named : split_figure({pictures.of(whole.name), whole.figure})) {
            const std::string fault = draw(named.figure, (folder / named.name).string(), picture_formats);
            if (!fault.empty()) remarks.push_back(named.name + ": " + fault);
            for (const std::string& ending : picture_formats)
                if (fault.empty()) files.push_back(named.name + "." + ending);
        }
    std::map<std::string, std::string> titles;
    for (const NamedTable& named : findings.tables)
        if (!named.is_shared && !named.title.empty()) titles[name_of(named)] = named.title;
    record_scenes(directory, plan);
    std::ranges::sort(files);
    files.erase(std::unique(files.begin(), files.end()), files.end());
    record_provenance(directory, plan.experiment, titles, files, findings.machines, command_line, quick);
    return remarks;
}

}  // namespace polhode
