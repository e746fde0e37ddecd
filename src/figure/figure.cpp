#include "figure/figure.h"

#include "figure/gnuplot.h"
#include "text/atomic_file.h"

namespace polhode {

std::string draw(const Figure& figure, const std::string& path_without_extension,
                 const std::vector<std::string>& formats, std::chrono::milliseconds time_limit) {
    std::vector<GnuplotRun> pictures;
    for (const std::string& format : formats) {
        pictures.push_back(gnuplot_picture(gnuplot_script(figure, format, ""), format, time_limit));
        if (!pictures.back().fault.empty()) return pictures.back().fault;
    }
    for (std::size_t i = 0; i < formats.size(); ++i)
        write_atomically(path_without_extension + "." + formats[i], pictures[i].output);
    return "";
}

}  // namespace polhode
