#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>

#include "places.h"
#include "table/table.h"
#include "text/decimal.h"

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
    const std::size_t begin = text.find("\\endfoot\n  ") + 11;
    std::string field = text.substr(begin, text.find(" \\\\\n", begin) - begin);
    // removes the marks at which a long name may be broken
    const std::string mark = "\\allowbreak{}";
    for (std::size_t at = field.find(mark); at != field.npos; at = field.find(mark)) field.erase(at, mark.size());
    return field;
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
    // three digits d.dd: half a unit of the last place is at most 0.005 relative to a mantissa >= 1; 1e-12 allows for
    // the rounding of this comparison
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

TEST(Latex, WritesALongtableWithBooktabsRules) {
    const Table table{{"method", "error (%)"}, {{"odeint_rk4", 1.2e-9}, {"R&D", Cell{}}}};
    const std::string text = latex(table, "Error of 100 % & more", "tab:a_b");
    for (const char* part :
         {"\\caption{Error of 100 \\% \\& more}\\label{tab:a_b}\\\\\n", "\\toprule\n", "\\midrule\n", "\\bottomrule\n",
          "odeint\\_\\allowbreak{}rk4 & \\num{1.2e-9} \\\\\n", "R\\&D &  \\\\\n", "\\end{longtable}\n"})
        EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
}

// a table that is too wide states columns with equal values once and lists those that only the CSV contains
TEST(Latex, LeavesOutWhatDoesNotFit) {
    Table table{{"scene", "status", "message"}, {}};
    for (int i = 0; i < 12; ++i) table.columns.push_back("error number " + std::to_string(i));
    for (int row = 0; row < 3; ++row) {
        std::vector<Cell> cells{"a scene", "ok", row == 0 ? Cell("why") : Cell()};
        for (int i = 0; i < 12; ++i) cells.emplace_back(1.234e-5 * (row + i + 1));
        table.rows.push_back(cells);
    }
    const std::string text = latex(table, "Wide", "");
    EXPECT_NE(text.find("Constant in all rows: status: ok; scene: a scene."), std::string::npos) << text;
    EXPECT_NE(text.find("Further columns in the CSV file: message, error number 11"), std::string::npos) << text;
    EXPECT_NE(text.find("\\num{1.23e-5}"), std::string::npos) << text;
}

// Numbers of every kind and long texts, under headings wider than their columns.
Table awkward_table() {
    Table table{{"discontinuities (rad)"}, {}};
    for (int i = 0; i < 6; ++i) table.columns.push_back("what the text describes " + std::to_string(i));
    for (const double value : {-1.234e-300, std::nan(""), infinity, -infinity, 0.0, 999.6}) {
        const std::string text = "ω ≤ 50 % & more, odeint_rk4_float32_projected, mApplyGyroscopicForceNow " +
                                 std::to_string(table.rows.size());
        table.rows.emplace_back(7, text)[0] = value;
    }
    return table;
}

// A published table, with its numbers parsed.
Table published(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    Table table = parse_csv(std::string(std::istreambuf_iterator<char>(file), {}));
    for (std::vector<Cell>& row : table.rows)
        for (Cell& cell : row)
            if (const auto number = parse_decimal(text_of(cell))) cell = *number;
    return table;
}

// Published tables and the awkward one compile with a real LaTeX in a plain article and fit its text width (345 pt).
TEST(Latex, TablesCompileAndFit) {
    if (std::system(
            "kpsewhich siunitx.sty longtable.sty booktabs.sty >/dev/null 2>&1 && command -v pdflatex >/dev/null") != 0)
        GTEST_SKIP() << "no LaTeX";
    namespace fs = std::filesystem;
    std::string pattern = (fs::temp_directory_path() / "polhode-tex-XXXXXX").string();
    ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
    std::vector<std::string> names;
    std::ofstream article(pattern + "/all.tex");
    article << "\\documentclass{article}\n\\usepackage{booktabs,longtable,siunitx}\n\\begin{document}\n";
    const auto input = [&](const fs::path& path) {
        names.push_back(path.stem().string());
        article << "\\input{" << path.string() << "}\n";
    };
    std::ofstream(pattern + "/awkward.tex") << latex(awkward_table(), "50 % of ω & more", "tab:a_b");
    input(pattern + "/awkward.tex");
    for (const auto& entry : fs::directory_iterator(source_dir() + "/results")) {
        constexpr std::uintmax_t largest = 100'000;  // bytes
        if (entry.path().extension() != ".csv" || entry.file_size() > largest) continue;
        const std::string name = entry.path().stem().string();
        std::ofstream(pattern + "/" + name + ".tex") << latex(published(entry.path()), name, "tab:" + name);
        input(pattern + "/" + name + ".tex");
    }
    EXPECT_GT(names.size(), 40U);
    article << "\\end{document}\n";
    article.close();
    EXPECT_EQ(
        std::system(("cd " + pattern + " && pdflatex -halt-on-error -interaction=nonstopmode all.tex >log").c_str()),
        0);
    std::ifstream log(pattern + "/all.log");
    for (std::string line; std::getline(log, line);) EXPECT_FALSE(line.starts_with("Overfull \\hbox")) << line;
    // longtable writes its column widths to the .aux file
    std::ifstream notes(pattern + "/all.aux");
    std::vector<double> widths;
    for (std::string line; std::getline(notes, line);) {
        if (line.find("\\gdef \\LT@") != line.npos) widths.push_back(0);
        for (std::size_t at = line.find("{"); at != line.npos; at = line.find("{", at + 1)) {
            char* end = nullptr;
            const double width = std::strtod(line.c_str() + at + 1, &end);
            if (std::string_view(end).starts_with("pt}")) widths.back() += width;
        }
    }
    ASSERT_EQ(widths.size(), names.size());
    for (std::size_t i = 0; i < names.size(); ++i) EXPECT_LE(widths[i], 345) << names[i];
    fs::remove_all(pattern);
}

TEST(Latex, WritesNumbersForSiunitx) {
    EXPECT_EQ(latex_cell(1e-10), "\\num{1e-10}");
    EXPECT_EQ(latex_cell(-1e5), "\\num{-1e5}");
    EXPECT_EQ(latex_cell(-0.25), "\\num{-0.25}");
    EXPECT_EQ(latex_cell(-infinity), "$-\\infty$");
    EXPECT_EQ(latex_cell(std::nan("")), "nan");
    EXPECT_EQ(latex_cell(12345L), "\\num{12345}");
}

TEST(Latex, EscapesEverySpecialCharacter) {
    EXPECT_EQ(latex_cell("\\{}$&#%_~^"), "\\textbackslash{}\\{\\}\\$\\&\\#\\%\\_\\textasciitilde{}\\textasciicircum{}");
    EXPECT_EQ(latex_cell("<|>\"`"), "\\textless{}\\textbar{}\\textgreater{}''\\textasciigrave{}");
    EXPECT_EQ(latex_cell("--step -1"), "-{}-step -1");
    EXPECT_EQ(latex_cell("ω² ≤ 3·10⁻³ größer"), "$\\omega$${}^2$ $\\le$ 3$\\cdot$10${}^-$${}^3$ größer");
    // without braces LaTeX would read these two as arguments of a preceding line break
    EXPECT_EQ(latex_cell("[1] *"), "{[}1] {*}");
    EXPECT_EQ(latex_cell("two\nlines\x01"), "two lines");
    EXPECT_EQ(latex_cell("cut \xcf"), "cut \xcf");
}

}  // namespace
}  // namespace polhode
