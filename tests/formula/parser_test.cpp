#include "formula/parser.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "body/algebra.h"
#include "formula/formula_values.h"
#include "formula/language.h"

namespace polhode {
namespace {

using test::formula_values;

double scalar_value(const std::string& text, double x = 0.7, double y = -1.3, double z = 2.1) {
    return formula_values(text, x, y, z).at(0);
}

TEST(Formula, HasTheValuesOfTheClosedForms) {
    const double x = 0.7, y = -1.3, z = 2.1;
    const std::pair<const char*, double> cases[] = {
        {"1 + 2*3", 7},
        {"2^3^2", 512},
        {"-x^2", -x * x},
        {"2^-1", 0.5},
        {"(x + y)*z", (x + y) * z},
        {"x/y/z", x / y / z},
        {"x - y - z", x - y - z},
        {"1.5e2*x", 150 * x},
        {".5*x", 0.5 * x},
        {"pi*x", std::numbers::pi * x},
        {"z^2.5", std::pow(z, 2.5)},
        {"z^1.3", std::pow(z, 1.3)},
        {"z^x", std::pow(z, x)},
        {"sqrt(z)", std::sqrt(z)},
        {"cbrt(y)", std::cbrt(y)},
        {"exp(y)", std::exp(y)},
        {"log(z)", std::log(z)},
        {"sin(z)", std::sin(z)},
        {"cos(z)", std::cos(z)},
        {"tan(x)", std::tan(x)},
        {"asin(x)", std::asin(x)},
        {"acos(x)", std::acos(x)},
        {"atan(y)", std::atan(y)},
        {"atan2(x, y)", std::atan2(x, y)},
        {"sinh(y)", std::sinh(y)},
        {"cosh(y)", std::cosh(y)},
        {"tanh(y)", std::tanh(y)},
        {"hypot(x, y)", std::hypot(x, y)},
        {"abs(y)", -y},
        {"sign(y)", -1},
        {"sign(x - x)", 0},
        {"min(x, y)", y},
        {"max(x, y)", x},
        {"clamp(z, -1, 1)", 1},
        {"clamp(y, -1, 1)", -1},
        {"clamp(x, -1, 1)", x},
        {"step(0*x)", 1},
        {"step(y)", 0},
        {"if(x < y, 1, 2)", 2},
        {"if(x >= y and z > 2, 1, 2)", 1},
        {"if(x < y or not z <= 2, 1, 2)", 1},
        {"if(not (x > y and z < 2), 1, 2)", 1},
        {"dot(r, [1, 2, 3])", x + 2 * y + 3 * z},
        {"cross(r, [0, 0, 1]).x", y},
        {"norm(r)^2", x * x + y * y + z * z},
        {"unit(r).z", z / std::sqrt(x * x + y * y + z * z)},
        {"(2*r - r/4).y", 2 * y - y / 4},
    };
    for (const auto& [text, expected] : cases)
        EXPECT_NEAR(scalar_value(text), expected, 4e-15 * std::max(1.0, std::abs(expected))) << text;
}

TEST(Formula, RotatesByTheAttitude) {
    const Quaternion<double> q{0.8, 0.36, -0.48, 0};
    const std::array<double, 4> attitude{q.w, q.x, q.y, q.z};
    const Vector3<double> v(0.7, -1.3, 2.1);
    const auto close = [&](const char* text, const Vector3<double>& expected) {
        const std::vector<double> found = formula_values(text, v[0], v[1], v[2], attitude);
        for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(found.at(i), expected[i], 1e-14) << text << " " << i;
    };
    close("to_world(r)", rotate(q, v));
    close("to_body(r)", rotate_back(q, v));
    close("inertia(r)", {2 * v[0] + 0.5 * v[1], 0.5 * v[0] + 3 * v[1], 4 * v[2]});
    // r = q0* q with q0 normalised
    const Quaternion<double> q0{0.6, 0, 0, 0.8}, r = conjugate(q0) * q;
    close("rotation_error([3, 0, 0, 4])", (r.w < 0 ? -2.0 : 2.0) * vector_part(r));
    const double sine = std::sqrt(dot(vector_part(r), vector_part(r)));
    close("rotation_vector([0.6, 0, 0, 0.8])",
          (2 * std::atan2(sine, std::abs(r.w)) * (r.w < 0 ? -1.0 : 1.0) / sine) * vector_part(r));
}

TEST(Formula, ReadsTables) {
    test::FormulaFixture fixture;
    fixture.scope.tables["ramp"] = {{0, 1, 3}, {2, 4, 0}, false};
    fixture.scope.tables["smooth"] = {{0, 1, 2, 4}, {0, 1, 4, 16}, true};
    const int ramp = fixture.parse("table(ramp, x)").component[0];
    const int smooth = fixture.parse("table(smooth, x)").component[0];
    const auto at = [&](int node, double x) { return fixture.values<double>({node}, {x, 0, 0, 1, 0, 0, 0})[0]; };
    const std::pair<double, double> expected[] = {{-1, 2}, {0, 2}, {0.5, 3}, {1, 4}, {2, 2}, {3, 0}, {9, 0}};
    for (const auto& [x, y] : expected) EXPECT_DOUBLE_EQ(at(ramp, x), y) << x;
    // through the points, monotone, and with a continuous derivative
    for (const auto& [x, y] : {std::pair{0.0, 0.0}, {1.0, 1.0}, {2.0, 4.0}, {4.0, 16.0}})
        EXPECT_NEAR(at(smooth, x), y, 1e-14);
    for (double x = 0; x < 4; x += 0.01) EXPECT_LE(at(smooth, x), at(smooth, x + 0.01));
    for (const double x : {1.0, 2.0}) {
        const double h = 1e-6, left = (at(smooth, x) - at(smooth, x - h)) / h;
        EXPECT_NEAR(left, (at(smooth, x + h) - at(smooth, x)) / h, 1e-4);
    }
    // harmonic mean of the secants 1 and 3 of intervals of length 1
    EXPECT_NEAR((at(smooth, 1 + 1e-6) - at(smooth, 1 - 1e-6)) / 2e-6, 2.0 / (1.0 + 1.0 / 3), 1e-5);
}

struct BadFormula {
    std::string text;
    std::size_t column;
    const char *fault, *remedy;
};

TEST(Formula, NamesTheColumnTheFaultAndTheRemedy) {
    const BadFormula cases[] = {
        {"", 1, "the formula is empty", "give an expression"},
        {"x +", 4, "the formula ends where a value is expected", "complete the formula"},
        {"x y", 3, "expected an operator, not \"y\"", "write products with \"*\""},
        {"x[0]", 2, "components are not numbered", "use .x, .y or .z"},
        {"2x", 2, "\"x\" follows a number", "write products with \"*\""},
        {"x)", 2, "expected an operator, not \")\"", "remove it, or open a bracket before it"},
        {"(x", 3, "the formula ends where \")\" is expected", "close the bracket"},
        {"[x, y", 6, "the formula ends where \"]\" is expected", "close the list"},
        {"[x, y]", 1, "the list has 2 elements", "give a vector [x, y, z] or a quaternion [w, x, y, z]"},
        {"x = y", 3, "\"=\" is not part of the language", "compare with <, <=, > or >="},
        {"x & y", 3, "\"&\" is not part of the language", "remove it"},
        {"1e999", 1, "number is beyond the range of binary64", "give a number below 1.8e308"},
        {"\"x", 1, "quoted name does not end", "add the closing quote"},
        {"*x", 1, "expected a value, not \"*\"", "give a number, a name or \"(\""},
        {"xx", 1, "unknown name \"xx\"", "known names: pi, q, r, x, y, z"},
        {"sine(x)", 1, "unknown function \"sine\"", "did you mean"},
        {"sin", 1, "the function \"sin\" has no arguments", "write sin(x)"},
        {"x(2)", 1, "\"x\" is a value, not a function", "write products with \"*\""},
        {"sin(x, y)", 1, "\"sin\" has 2 arguments", "write sin(x)"},
        {"atan2(x)", 1, "\"atan2\" has 1 argument", "write atan2(y, x)"},
        {"sin()", 1, "\"sin\" has 0 arguments", "write sin(x)"},
        {"sin(r)", 5, "\"r\" is a vector, but sin(x) needs a scalar", "take a component such as .x, or norm(v)"},
        {"norm(x)", 6, "\"x\" is a scalar, but norm(v) needs a vector", "give a vector such as [x, y, z]"},
        {"r*r", 2, "a vector and a vector cannot be multiplied", "use dot(a, b) or cross(a, b)"},
        {"x/r", 2, "division by a vector", "divide by a scalar, for example norm(v)"},
        {"x + r", 3, "a scalar and a vector cannot be added or subtracted", "give two scalars or two vectors"},
        {"r.w", 3, "\"w\" is not a component", "use .x, .y or .z"},
        {"x.y", 1, "\"x\" is a scalar, but a component needs a vector", "give a vector such as [x, y, z]"},
        {"q*2", 2, "a quaternion and a scalar cannot be multiplied or divided", "only as an argument of a function"},
        {"r^2", 1, "\"r\" is a vector, but the base of \"^\" needs a scalar", "norm(v)"},
        {"x < y", 1, "the condition \"x < y\" is not a number", "use it as if(condition, a, b)"},
        {"if(x, 1, 2)", 4, "\"x\" is a number, but \"if\" needs a condition", "compare it: if(x > 0, a, b)"},
        {"if(x < y < z, 1, 2)", 10, "comparisons do not chain", "join two comparisons with \"and\""},
        {"if(x and y > 0, 1, 2)", 4, "\"x\" is a number, but \"and\" needs a condition", "compare it: x > 0"},
        {"if(not x, 1, 2)", 8, "\"x\" is a number, but \"not\" needs a condition", "compare it: not x > 0"},
        {"if(x > y, 1, r)", 1, "\"if\" chooses between a scalar and a vector", "give two values of the same type"},
        {"table(thrust, x)", 7, "unknown table \"thrust\"", "define it in \"tables\""},
        {"rotation_error(r)", 16, "\"r\" is a vector, but rotation_error(q0) needs a quaternion",
         "give a quaternion [w, x, y, z]"},
        {std::string(200, '('), 101, "the formula is nested deeper than 100", "name parts of it in \"let\""},
        {std::string(200, '-') + "x", 100, "the formula is nested deeper than 100", "name parts of it in \"let\""},
        {std::string(20'000, ' '), 10'001, "the formula has more than 10000 characters", "name parts of it in \"let\""},
    };
    for (const BadFormula& one : cases) {
        test::FormulaFixture fixture;
        try {
            fixture.parse(one.text);
            ADD_FAILURE() << one.text << ": no error";
        } catch (const formula::FormulaError& error) {
            EXPECT_EQ(error.column(), one.column) << one.text;
            EXPECT_NE(std::string(error.what()).find(one.fault), std::string::npos) << one.text << ": " << error.what();
            EXPECT_NE(error.remedy().find(one.remedy), std::string::npos) << one.text << ": " << error.remedy();
        }
    }
}

TEST(Formula, SharesEqualOperationsAndLimitsTheirNumber) {
    test::FormulaFixture fixture;
    const int first = fixture.parse("sin(2*x + y)/(y + x*2)").component[0];
    const std::size_t before = fixture.expression.nodes().size();
    EXPECT_EQ(fixture.parse("sin(y + x*2)/(2*x + y)").component[0], first);
    EXPECT_EQ(fixture.expression.nodes().size(), before);
    // three operations each
    const auto add_many = [&] {
        for (int i = 0; i < 4000; ++i) fixture.parse("sin(" + std::to_string(i) + ".5*x)");
    };
    EXPECT_THROW(add_many(), formula::FormulaError);
    EXPECT_EQ(fixture.expression.nodes().size(), formula::most_operations);
}

TEST(Formula, ListsEveryFunctionOnce) {
    for (const formula::FunctionEntry& entry : formula::formula_functions()) {
        EXPECT_TRUE(formula::is_reserved(entry.name));
        int count = 0;
        for (const formula::FunctionEntry& other : formula::formula_functions()) count += other.name == entry.name;
        EXPECT_EQ(count, 1) << entry.name;
    }
}

}  // namespace
}  // namespace polhode
