#include "figure/figure.h"

#include "figure/gnuplot.h"
#include "text/atomic_file.h"

namespace polhode {

std::string draw(const Figure& figure, const std::string& path_without_extension,
                 std::chrono::milliseconds time_limit) {
    const GnuplotRun svg = gnuplot_picture(gnuplot_script(figure, "svg", ""), "svg", time_limit);
    if (!svg.fault.empty()) return svg.fault;
    const GnuplotRun pdf = gnuplot_picture(gnuplot_script(figure, "pdf", ""), "pdf", time_limit);
    if (!pdf.fault.empty()) return pdf.fault;
    write_atomically(path_without_extension + ".svg", svg.output);
    write_atomically(path_without_extension + ".pdf", pdf.output);
    return "";
}

}  // namespace polhode
