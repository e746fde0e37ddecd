#include "experiment/run/report.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <stdexcept>
#include <utility>

#include "experiment/run/provenance.h"
#include "text/atomic_file.h"

namespace polhode {
namespace {

// the rows of other experiments stay
void write_shared(const std::string& experiment, Table table, const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    try {
        const Table old = parse_csv(std::string(std::istreambuf_iterator<char>(file), {}));
        if (old.columns == table.columns)
            for (const auto& row : old.rows)
                if (text_of(row.back()) != experiment) table.rows.push_back(row);
    } catch (const std::invalid_argument&) {
        // none there yet, or none of ours
    }
    std::stable_sort(table.rows.begin(), table.rows.end(),
                     [](const auto& a, const auto& b) { return text_of(a.back()) < text_of(b.back()); });
    write_atomically(path.string(), csv(table));
}

// A scene's name may hold a slash: in the name of a file it would be a directory.
std::string file_name(std::string name) {
    std::replace(name.begin(), name.end(), '/', '_');
    return name;
}

}  // namespace

NamedTable headed_table(std::string name, std::string title, const std::vector<ColumnChoice>& columns) {
    NamedTable named{std::move(name), std::move(title), {}};
    for (const ColumnChoice& column : columns) {
        named.table.columns.push_back(column.column);
        if (!column.heading.empty()) named.for_people.push_back(column);
    }
    return named;
}

Table page_of(const NamedTable& named) {
    if (named.page) return *named.page;
    return named.for_people.empty() ? named.table : select(named.table, named.for_people);
}

std::vector<std::string> write_report(const Plan& plan, const Findings& findings, const std::string& directory,
                                      const std::string& command_line, bool quick) {
    const std::string& experiment = plan.experiment.name;
    const std::filesystem::path folder(directory);
    std::filesystem::create_directories(folder);
    for (const NamedTable& named : findings.tables) {
        if (named.is_shared) {
            write_shared(experiment, named.table, folder / (named.name + ".csv"));
            continue;
        }
        const std::string name = named.name.empty() ? experiment : experiment + "_" + named.name;
        const std::string path = (folder / name).string();
        write_atomically(path + ".csv", csv(named.table));
        if (named.only_csv) continue;
        const Table page = page_of(named);
        write_atomically(path + ".json", json(named.table));
        write_atomically(path + ".md", markdown(page));
        write_atomically(path + ".tex",
                         latex(page, named.title.empty() ? plan.experiment.about : named.title, "tab:" + name));
    }
    if (!findings.page.empty()) write_atomically((folder / (experiment + ".md")).string(), findings.page);
    std::vector<std::string> remarks;
    for (const NamedFigure& whole : findings.figures)
        for (const NamedFigure& named : split_figure({file_name(whole.name), whole.figure})) {
            const std::string fault = draw(named.figure, (folder / named.name).string());
            if (!fault.empty()) remarks.push_back(named.name + ": " + fault);
        }
    std::map<std::string, std::string> titles;
    for (const NamedTable& named : findings.tables)
        if (!named.is_shared && !named.title.empty())
            titles[named.name.empty() ? experiment : experiment + "_" + named.name] = named.title;
    record_scenes(directory, plan);
    record_provenance(directory, plan.experiment, titles, command_line, quick);
    return remarks;
}

}  // namespace polhode
