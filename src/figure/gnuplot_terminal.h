// What every gnuplot script of ours says to its terminal: sizes in points (1/72 inch), strings that show literally.
#pragma once

#include <string>

namespace polhode {

/// A string in double quotes in which nothing has a meaning: no escape, no command substitution, no end.
std::string gnuplot_quoted(const std::string& text);

/// A string in double quotes in which nothing has a meaning, on one line: control characters become spaces.
std::string gnuplot_quoted_line(std::string text);

/// gnuplot's svg or pdfcairo terminal; sizes are in points, in its own unit where it is told.
class GnuplotTerminal {
  public:
    /// "svg" or "pdf"; std::invalid_argument else.
    explicit GnuplotTerminal(const std::string& name);

    bool svg() const { return svg_; }
    double font_size(double points) const;
    std::string font(double points) const;  ///< as in `set label .. font F`
    double line_width(double points) const;
    /// The commands before the first plot: encoding, terminal, output (standard output if `path` is empty).
    std::string opening(double width, double height, double points, const std::string& path) const;

  private:
    bool svg_;
};

}  // namespace polhode
