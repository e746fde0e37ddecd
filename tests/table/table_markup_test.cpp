#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>

#include "table/table.h"

namespace polhode {
namespace {

std::string markdown_cell(const Cell& cell) {
    const std::string text = markdown({{"h"}, {{cell}}});
    const std::size_t begin = text.rfind("\n| ") + 3;
    std::string field = text.substr(begin, text.rfind(" |") - begin);
    field.erase(0, field.find_first_not_of(' '));
    field.erase(field.find_last_not_of(' ') + 1);
    return field;
}

std::string latex_cell(const Cell& cell) {
    const std::string text = latex({{"h"}, {{cell}}}, "", "");
    const std::size_t begin = text.find("\\midrule\n    ") + 13;
    return text.substr(begin, text.find(" \\\\\n", begin) - begin);
}

const double infinity = std::numeric_limits<double>::infinity();

TEST(Markdown, AlignsNumbersToTheRight) {
    const Table table{{"method", "error (rad)", "steps"},
                      {{"odeint_rk4", 1.23456e-9, 1000000L}, {"a|b", Cell{}, Cell{}}, {"ω", 0.5, 3L}}};
    EXPECT_EQ(markdown(table),
              "| method     | error (rad) |   steps |\n"
              "| ---------- | ----------: | ------: |\n"
              "| odeint_rk4 |     1.23e-9 | 1000000 |\n"
              "| a\\|b       |             |         |\n"
              "| ω          |         0.5 |       3 |\n");
}

TEST(Markdown, RoundsToThreeDigits) {
    EXPECT_EQ(markdown_cell(0.0), "0");
    EXPECT_EQ(markdown_cell(-0.0), "0");
    EXPECT_EQ(markdown_cell(1e-10), "1e-10");
    EXPECT_EQ(markdown_cell(-1.2e-9), "-1.2e-9");
    EXPECT_EQ(markdown_cell(0.0012345), "0.00123");
    EXPECT_EQ(markdown_cell(0.00099999), "0.001");
    EXPECT_EQ(markdown_cell(0.00099949), "9.99e-4");
    EXPECT_EQ(markdown_cell(123.456), "123");
    EXPECT_EQ(markdown_cell(999.4), "999");
    EXPECT_EQ(markdown_cell(999.6), "1e3");
    EXPECT_EQ(markdown_cell(1234.0), "1.23e3");
    EXPECT_EQ(markdown_cell(100.0), "100");
    EXPECT_EQ(markdown_cell(2e300), "2e300");
    EXPECT_EQ(markdown_cell(infinity), "inf");
}

RC_GTEST_PROP(Markdown, StaysWithinHalfAUnitOfTheThirdDigit, (double value)) {
    // three digits d.dd: half a unit of the last is at most 0.005 of a mantissa of at least 1; the second term is the
    // rounding of the comparison itself
    RC_PRE(std::isfinite(value) && std::abs(value) < 1e300);
    const double read = std::strtod(markdown_cell(value).c_str(), nullptr);
    RC_ASSERT(std::abs(read - value) <= 0.005 * std::abs(value) * (1 + 1e-12));
}

TEST(Markdown, EscapesMarkup) {
    EXPECT_EQ(markdown_cell("a_b"), "a_b");
    EXPECT_EQ(markdown_cell("_a_ *b* `c`"), "\\_a\\_ \\*b\\* \\`c\\`");
    EXPECT_EQ(markdown_cell("<b>&amp; [x](y) ~~z~~ $q$ \\"), "\\<b>\\&amp; \\[x\\](y) \\~\\~z\\~\\~ \\$q\\$ \\\\");
    EXPECT_EQ(markdown_cell("two\nlines\r\tx"), "two<br>lines x");
}

TEST(Latex, WritesATableWithBooktabsRules) {
    const Table table{{"method", "error (%)"}, {{"odeint_rk4", 1.2e-9}, {"R&D", Cell{}}}};
    EXPECT_EQ(latex(table, "Error of 100 % & more", "tab:a_b"),
              "\\begin{table}\n"
              "  \\centering\n"
              "  \\caption{Error of 100 \\% \\& more}\n"
              "  \\label{tab:a_b}\n"
              "  \\begin{tabular}{lr}\n"
              "    \\toprule\n"
              "    method & error (\\%) \\\\\n"
              "    \\midrule\n"
              "    odeint\\_rk4 & $1.2\\times10^{-9}$ \\\\\n"
              "    R\\&D &  \\\\\n"
              "    \\bottomrule\n"
              "  \\end{tabular}\n"
              "\\end{table}\n");
}

TEST(Latex, WritesNumbersInMath) {
    EXPECT_EQ(latex_cell(1e-10), "$10^{-10}$");
    EXPECT_EQ(latex_cell(-1e5), "$-10^{5}$");
    EXPECT_EQ(latex_cell(-0.25), "$-0.25$");
    EXPECT_EQ(latex_cell(-infinity), "$-\\infty$");
    EXPECT_EQ(latex_cell(std::nan("")), "nan");
    EXPECT_EQ(latex_cell(12345L), "12345");
}

TEST(Latex, EscapesEverySpecialCharacter) {
    EXPECT_EQ(latex_cell("\\{}$&#%_~^"), "\\textbackslash{}\\{\\}\\$\\&\\#\\%\\_\\textasciitilde{}\\textasciicircum{}");
    EXPECT_EQ(latex_cell("<|>\"`"), "\\textless{}\\textbar{}\\textgreater{}''\\textasciigrave{}");
    EXPECT_EQ(latex_cell("--step -1"), "-{}-step -1");
    EXPECT_EQ(latex_cell("ω² ≤ 3·10⁻³ größer"), "$\\omega$${}^2$ $\\le$ 3$\\cdot$10${}^-$${}^3$ größer");
    // these two would be read as arguments of the \\ before them
    EXPECT_EQ(latex_cell("[1] *"), "{[}1] {*}");
    EXPECT_EQ(latex_cell("two\nlines\x01"), "two lines");
    EXPECT_EQ(latex_cell("cut \xcf"), "cut \xcf");
}

}  // namespace
}  // namespace polhode
