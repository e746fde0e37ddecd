#include "figure/gnuplot.h"

#include <string_view>
#include <utility>

#include "text/child_process.h"

namespace polhode {
namespace {

/// Cairo writes the current time into a PDF's /CreationDate (D:yyyymmddhhmmssZ); replaces it by the epoch.
void clear_creation_date(std::string& pdf) {
    const std::string_view key = "/CreationDate (D:";
    const std::size_t place = pdf.rfind(key);
    if (place == std::string::npos) return;
    const std::string_view epoch = "19700101000000";
    std::size_t i = place + key.size();
    for (const char digit : epoch) {
        if (i < pdf.size() && pdf[i] >= '0' && pdf[i] <= '9') pdf[i++] = digit;
    }
}

/// gnuplot writes a label's ]]> unescaped, which is invalid in XML text.
void escape_ends_of_sections(std::string& svg) {
    const std::string_view end = "]]>", escaped = "]]&gt;";
    for (std::size_t at = svg.find(end); at != std::string::npos; at = svg.find(end, at + escaped.size()))
        svg.replace(at, end.size(), escaped);
}

}  // namespace

GnuplotRun run_gnuplot(const std::string& script, std::chrono::milliseconds time_limit) {
    ChildRun run = run_child({"gnuplot", "-d"}, script, {.time = time_limit});
    return run.fault.empty() ? GnuplotRun{std::move(run.output), ""} : GnuplotRun{"", std::move(run.fault)};
}

GnuplotRun gnuplot_picture(const std::string& script, const std::string& terminal,
                           std::chrono::milliseconds time_limit) {
    GnuplotRun run = run_gnuplot(script, time_limit);
    if (!run.fault.empty()) return run;
    const bool svg = terminal == "svg";
    if (run.output.find(svg ? "</svg>" : "%%EOF") == std::string::npos)
        return {"", svg ? "gnuplot wrote no complete SVG" : "gnuplot wrote no complete PDF"};
    if (svg)
        escape_ends_of_sections(run.output);
    else
        clear_creation_date(run.output);
    return run;
}

}  // namespace polhode
