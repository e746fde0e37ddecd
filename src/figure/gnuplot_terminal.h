// Terminal set-up shared by all gnuplot scripts: sizes in points (1/72 inch), and quoting of literal strings.
#pragma once

#include <string>

namespace polhode {

/// A double-quoted string in which every character is literal: no escapes, no command substitution, no early end.
std::string gnuplot_quoted(const std::string& text);

/// A literal double-quoted string on one line: control characters become spaces.
std::string gnuplot_quoted_line(std::string text);

/// gnuplot's svg or pdfcairo terminal. Sizes are in points and are converted to the terminal's unit.
class GnuplotTerminal {
  public:
    /// `name` is "svg" or "pdf". Throws std::invalid_argument otherwise.
    explicit GnuplotTerminal(const std::string& name);

    bool svg() const { return svg_; }
    double font_size(double points) const;
    std::string font(double points) const;  ///< font argument, as in `set label .. font F`
    double line_width(double points) const;
    /// The commands before the first plot: encoding, terminal, output (standard output if `path` is empty). Sizes in
    /// points.
    std::string opening(double width, double height, double points, const std::string& path) const;

  private:
    bool svg_;
};

}  // namespace polhode
