#include "text/csv_lines.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>

#include "text/message.h"

namespace polhode {
namespace {

const std::string csv_file = "t.csv";

// Everything CsvLines returns for a text: the cells of each line, and the remark or error at the end.
std::string read_all(CsvLines&& lines) {
    std::string all;
    try {
        while (lines.next()) {
            all += std::to_string(lines.number()) + ':';
            for (const std::string_view cell : lines.cells()) all.append(cell).append("|");
            all += '\n';
        }
        all += lines.skipped_content();
    } catch (const InputError& error) {
        all += error.what();
    }
    return all;
}

// A source that returns the text in pieces of at most `most` bytes.
CsvLines::Source source_of(const std::string& text, std::size_t most) {
    return [&text, most, at = std::size_t{0}](char* bytes, std::size_t count) mutable {
        const std::size_t n = std::min({count, most, text.size() - at});
        std::copy_n(text.begin() + static_cast<std::ptrdiff_t>(at), n, bytes);
        at += n;
        return n;
    };
}

void expect_same(const std::string& text) {
    const std::string whole = read_all(CsvLines(text, csv_file));
    for (const std::size_t most : {std::size_t{1}, std::size_t{2}, std::size_t{7}, std::size_t{1} << 30})
        EXPECT_EQ(read_all(CsvLines(source_of(text, most), csv_file)), whole)
            << testing::PrintToString(text.substr(0, 100));
}

TEST(CsvLines, AStreamIsReadAsItsText) {
    const std::string long_line((64 << 10) - 2, 'x');
    for (const std::string& text :
         {std::string(), std::string("a"), std::string("a,b\n1,2\r\n3,4\r\n"), std::string("\xef\xbb\xbf"),
          std::string("\xef\xbb\xbf"
                      "a,b\n#c\n 1 ,2\n\n \t\n"),
          std::string("\xef\xbb"), std::string("a\n\nb"), std::string("a\n \n\n\nb\n"), std::string("a\0b\n", 4),
          std::string("\n"), std::string("a\n") + std::string(9, '\n'), "ab" + long_line, "abc" + long_line,
          "ab" + long_line + "\r\nx,y", "#" + long_line + "abc\n", "a\n" + long_line + "\n1",
          std::string(70'000, ' ') + "\n"})
        expect_same(text);
}

TEST(CsvLines, ALongTextIsReadAsItsText) {
    std::string text;
    for (int i = 0; text.size() < 700'000; ++i) text += std::string(static_cast<std::size_t>(i % 5000), 'x') + ",1\n";
    const std::string whole = read_all(CsvLines(text, csv_file));
    for (const std::size_t most : {1000u, 65'537u, 1u << 30})
        EXPECT_EQ(read_all(CsvLines(source_of(text, most), csv_file)), whole);
}

RC_GTEST_PROP(CsvLinesProperties, AnyTextIsReadAsItsStream, ()) {
    const auto characters = *rc::gen::container<std::string>(rc::gen::elementOf(std::string("ab,\n\n\r \t#")));
    const auto most = *rc::gen::inRange<std::size_t>(1, 5);
    RC_ASSERT(read_all(CsvLines(source_of(characters, most), csv_file)) == read_all(CsvLines(characters, csv_file)));
}

}  // namespace
}  // namespace polhode
