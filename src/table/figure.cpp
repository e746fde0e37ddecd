#include "table/figure.h"

#include <stdexcept>
#include <string_view>

#include "table/atomic_file.h"
#include "table/gnuplot.h"

namespace polhode {

namespace {

/// Cairo writes the time of day into a PDF's /CreationDate (D:yyyymmddhhmmssZ): the date
/// becomes the epoch.
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

}  // namespace

std::string draw(const Figure& figure, const std::string& path_without_extension,
                 std::chrono::milliseconds time_limit) {
    GnuplotRun svg = run_gnuplot(gnuplot_script(figure, "svg", ""), time_limit);
    if (!svg.fault.empty()) return svg.fault;
    GnuplotRun pdf = run_gnuplot(gnuplot_script(figure, "pdf", ""), time_limit);
    if (!pdf.fault.empty()) return pdf.fault;
    if (svg.output.find("</svg>") == std::string::npos) return "gnuplot wrote no complete SVG";
    if (pdf.output.find("%%EOF") == std::string::npos) return "gnuplot wrote no complete PDF";
    clear_creation_date(pdf.output);
    try {
        write_atomically(path_without_extension + ".svg", svg.output);
        write_atomically(path_without_extension + ".pdf", pdf.output);
    } catch (const std::runtime_error& error) {
        return error.what();
    }
    return "";
}

}  // namespace polhode
