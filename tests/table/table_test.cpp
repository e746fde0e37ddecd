#include "table/table.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

namespace polhode {
namespace {

Table small_table() {
    return {{"method", "seconds", "steps", "message"},
            {{"odeint_rk4", 0.1, 1000L, Cell{}}, {"cvode, \"adams\"", -2.5e-9, 0L, "two\nlines"}}};
}

std::string fault_of(std::string_view text) {
    try {
        parse_csv(text);
    } catch (const std::invalid_argument& error) {
        return error.what();
    }
    return "none";
}

/// Text with the characters that CSV must quote and characters of two to four bytes.
rc::Gen<std::string> awkward_text() {
    const auto piece =
        rc::gen::element<std::string>(",", "\"", "\n", "\r", "\r\n", " ", "a", "1", "ω", "€", "𝄞", "\t", "");
    return rc::gen::map(rc::gen::container<std::vector<std::string>>(piece),
                        [](const std::vector<std::string>& pieces) {
                            std::string text;
                            for (const std::string& p : pieces) text += p;
                            return text;
                        });
}

rc::Gen<Cell> any_cell() {
    return rc::gen::oneOf(rc::gen::just(Cell{}), rc::gen::map(awkward_text(), [](std::string s) { return Cell{s}; }),
                          rc::gen::map(rc::gen::arbitrary<double>(), [](double x) { return Cell{x}; }),
                          rc::gen::map(rc::gen::arbitrary<long>(), [](long n) { return Cell{n}; }));
}

/// At most 5 columns and 6 rows: errors occur within a cell or between neighbours.
Table any_table() {
    Table table;
    const std::size_t most_columns = *rc::gen::inRange<std::size_t>(1, 6);
    std::set<std::string> names;
    for (std::size_t i = 0; i < most_columns; ++i) names.insert(*rc::gen::resize(10, awkward_text()));
    table.columns.assign(names.begin(), names.end());
    const auto row = rc::gen::container<std::vector<Cell>>(table.columns.size(), rc::gen::scale(0.3, any_cell()));
    table.rows = *rc::gen::container<std::vector<std::vector<Cell>>>(*rc::gen::inRange<std::size_t>(0, 7), row);
    return table;
}

TEST(Csv, QuotesWhatNeedsItAndNothingElse) {
    EXPECT_EQ(csv(small_table()),
              "method,seconds,steps,message\n"
              "odeint_rk4,0.1,1000,\n"
              "\"cvode, \"\"adams\"\"\",-2.5e-09,0,\"two\nlines\"\n");
}

RC_GTEST_PROP(Csv, ReadsBackEveryCell, ()) {
    const Table written = any_table();
    const Table read = parse_csv(csv(written));
    RC_ASSERT(read.columns == written.columns);
    RC_ASSERT(read.rows.size() == written.rows.size());
    for (std::size_t row = 0; row < read.rows.size(); ++row) {
        for (std::size_t column = 0; column < read.columns.size(); ++column) {
            RC_ASSERT(text_of(read.rows[row][column]) == text_of(written.rows[row][column]));
            RC_ASSERT(std::holds_alternative<std::monostate>(read.rows[row][column]) ==
                      text_of(written.rows[row][column]).empty());
        }
    }
}

RC_GTEST_PROP(Csv, NumbersReadBackToTheSameBits, (double value)) {
    // strtod is correctly rounded in glibc and shares no code with to_chars
    const double read = std::strtod(text_of(value).c_str(), nullptr);
    RC_ASSERT((std::isnan(value) ? std::isnan(read) : read == value && std::signbit(read) == std::signbit(value)));
}

TEST(Csv, NumbersAtTheEdgesReadBack) {
    using Limits = std::numeric_limits<double>;
    for (const double value :
         {Limits::denorm_min(), Limits::min(), Limits::max(), 0.1, 1e23, -0.0, Limits::infinity()}) {
        const double read = std::strtod(text_of(value).c_str(), nullptr);
        EXPECT_EQ(read, value);
        EXPECT_EQ(std::signbit(read), std::signbit(value));
    }
    EXPECT_EQ(text_of(0.1), "0.1");
    EXPECT_EQ(text_of(-Limits::quiet_NaN()), "nan");
    EXPECT_EQ(text_of(std::numeric_limits<long>::min()), "-9223372036854775808");
}

TEST(Csv, TakesOtherLineEndings) {
    const Table table = parse_csv("a,b\r\n1,\"x\r\ny\"\r\n,2");
    ASSERT_EQ(table.rows.size(), 2u);
    EXPECT_EQ(text_of(table.rows[0][1]), "x\r\ny");
    EXPECT_EQ(text_of(table.rows[1][0]), "");
    EXPECT_EQ(text_of(table.rows[1][1]), "2");
}

TEST(Csv, NamesLineAndFault) {
    EXPECT_EQ(fault_of(""), "line 1: the header is missing");
    EXPECT_EQ(fault_of("a,b,a\n"), "line 1: two columns are named 'a'");
    EXPECT_EQ(fault_of("a,b\n1,2\n1\n"), "line 3: 1 field under 2 columns");
    EXPECT_EQ(fault_of("a,b\n\"x\ny\",2\n1,2,3\n"), "line 4: 3 fields under 2 columns");
    EXPECT_EQ(fault_of("a\nb\"c\n"), "line 2: a quote inside the unquoted field 'b\"c'");
    EXPECT_EQ(fault_of("a\n\"b\"c\n"), "line 2: text after a closing quote");
    EXPECT_EQ(fault_of("a\nb\n\"c\nd\n"), "line 3: an opening quote has no closing quote");
    EXPECT_EQ(fault_of("a,b\n1,2\n"), "none");
}

TEST(Json, WritesAnObjectALine) {
    EXPECT_EQ(json(small_table()),
              "[\n"
              " {\"method\": \"odeint_rk4\", \"seconds\": 0.1, \"steps\": 1000, \"message\": null},\n"
              " {\"method\": \"cvode, \\\"adams\\\"\", \"seconds\": -2.5e-09, \"steps\": 0, \"message\": "
              "\"two\\nlines\"}\n"
              "]\n");
    EXPECT_EQ(json({{"a"}, {}}), "[\n]\n");
}

RC_GTEST_PROP(Json, IsReadBackByAParser, ()) {
    const Table table = any_table();
    const auto read = nlohmann::json::parse(json(table));
    RC_ASSERT(read.size() == table.rows.size());
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
        for (std::size_t column = 0; column < table.columns.size(); ++column) {
            const Cell& cell = table.rows[row][column];
            const auto& value = read.at(row).at(table.columns[column]);
            if (const auto* word = std::get_if<std::string>(&cell)) {
                RC_ASSERT(value.get<std::string>() == *word);
            } else if (const auto* count = std::get_if<long>(&cell)) {
                RC_ASSERT(value.get<long>() == *count);
            } else if (const auto* number = std::get_if<double>(&cell); number != nullptr && std::isfinite(*number)) {
                RC_ASSERT(value.get<double>() == *number);
            } else {
                RC_ASSERT(value.is_null());
            }
        }
    }
}

TEST(Json, EscapesControlCharactersAndReplacesBrokenText) {
    EXPECT_EQ(json({{"a"}, {{std::string("\x01\t\x7f\xff")}}}), "[\n {\"a\": \"\\u0001\\t\x7f\xef\xbf\xbd\"}\n]\n");
    EXPECT_EQ(json({{"a"}, {{std::numeric_limits<double>::infinity()}, {std::nan("")}}}),
              "[\n {\"a\": null},\n {\"a\": null}\n]\n");
}

TEST(Select, TakesColumnsInOrderUnderTheirHeadings) {
    const Table chosen = select(small_table(), {{"steps", "Steps"}, {"method", "Method"}});
    EXPECT_EQ(csv(chosen), "Steps,Method\n1000,odeint_rk4\n0,\"cvode, \"\"adams\"\"\"\n");
    EXPECT_THROW(select(small_table(), {{"speed", "Speed"}}), std::invalid_argument);
    EXPECT_EQ(column_index(small_table(), "steps"), 2u);
}

TEST(Writers, RefuseARaggedTable) {
    const Table ragged{{"a", "b"}, {{1.0}}}, none;
    for (const Table& table : {ragged, none}) {
        EXPECT_THROW(csv(table), std::invalid_argument);
        EXPECT_THROW(json(table), std::invalid_argument);
        EXPECT_THROW(markdown(table), std::invalid_argument);
        EXPECT_THROW(latex(table, "", ""), std::invalid_argument);
    }
    EXPECT_THROW(csv({{"a", "a"}, {}}), std::invalid_argument);
    EXPECT_THROW(json({{"a", "a"}, {}}), std::invalid_argument);
}

}  // namespace
}  // namespace polhode
