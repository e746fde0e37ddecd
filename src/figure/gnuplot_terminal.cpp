#include "figure/gnuplot_terminal.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace polhode {

std::string gnuplot_quoted(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte < 0x20 || byte == 0x7f || c == '"' || c == '\\' || c == '`') {
            out += fmt::format("\\{:03o}", byte);
        } else {
            out += c;
        }
    }
    return out + '"';
}

std::string gnuplot_quoted_line(std::string text) {
    for (char& c : text) {
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
    }
    return gnuplot_quoted(text);
}

GnuplotTerminal::GnuplotTerminal(const std::string& name) : svg_(name == "svg") {
    if (!svg_ && name != "pdf") {
        throw std::invalid_argument(fmt::format("a figure's terminal is svg or pdf, not '{}'", name));
    }
}

// SVG: pixels of 1/96 inch, as in CSS. PDF: units of 4/3 points, since Pango assumes 96 per inch.
double GnuplotTerminal::font_size(double points) const {
    return svg_ ? std::round(points * 40 / 3) / 10 : points * 3 / 4;
}

std::string GnuplotTerminal::font(double points) const { return fmt::format("\",{:g}\"", font_size(points)); }

double GnuplotTerminal::line_width(double points) const { return svg_ ? points * 4 / 3 : points * 3; }

std::string GnuplotTerminal::opening(double width, double height, double points, const std::string& path) const {
    std::string text = "set encoding utf8\n";
    if (svg_) {
        text += fmt::format(
            "set terminal svg size {:.0f},{:.0f} dynamic enhanced background \"white\" "
            "font \"DejaVu Sans,Verdana,sans-serif,{:g}\" linewidth 1\n",
            width * 4 / 3, height * 4 / 3, font_size(points));
    } else {
        text += fmt::format(
            "set terminal pdfcairo size {:.4f}in,{:.4f}in enhanced font \"DejaVu Sans,{:g}\" "
            "fontscale 1 linewidth 0.5 rounded\n",
            width / 72, height / 72, font_size(points));
    }
    // gnuplot interprets a leading | as a command and a leading ~ as the home directory
    if (!path.empty()) text += "set output " + gnuplot_quoted(path.front() == '/' ? path : "./" + path) + '\n';
    return text;
}

}  // namespace polhode
