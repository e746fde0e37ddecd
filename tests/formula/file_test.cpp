// Formulas in scene files: reading, writing and messages.
#include <gtest/gtest.h>

#include "formula/formula_scene.h"
#include "text/message.h"

namespace polhode {
namespace {

std::string fault_of(const std::string& members) {
    try {
        test::formula_scene(members);
    } catch (const InputError& error) {
        return error.what();
    }
    return "no error";
}

TEST(FormulaFile, IsWrittenAndReadBack) {
    const Scene scene = test::formula_scene(
        R"json("parameters": {"k": 0.3, "mu": 2e14}, "tables": {"f": {"x": [0, 1], "y": [2, 3], "between": "cubic"}},
           "let": {"r": "norm(p)", "n": "p/r"},
           "loads": [{"type": "torque", "frame": "body", "formula": ["k", 0, "table(f, t)"], "from": 1},
                     {"type": "force", "frame": "world", "formula": "-mu*n", "point": [1, 2, 3]},
                     {"type": "potential", "formula": "k*r", "until": 2}])json");
    const std::string text = write_scene(scene);
    EXPECT_EQ(write_scene(parse_scene(text, "written.json", "")), text);
    EXPECT_NE(text.find(R"json("formula": "[k, 0, table(f, t)]")json"), std::string::npos) << text;
}

struct BadScene {
    const char *members, *message;
};

TEST(FormulaFile, ReportsPlaceColumnFaultAndRemedy) {
    const BadScene cases[] = {
        {R"json("loads": [{"type": "torque", "frame": "body", "formula": "-stifness*w"}], "parameters": {"stiffness": 1})json",
         "formulas.json: /loads/0/formula: column 2: unknown name \"stifness\"; did you mean stiffness?"},
        {R"json("loads": [{"type": "torque", "frame": "body", "formula": "w.x"}])json",
         "/loads/0/formula: column 1: the formula is a scalar, but a torque is a vector"},
        {R"json("loads": [{"type": "force", "frame": "world", "formula": "norm(v)"}])json",
         "/loads/0/formula: column 1: the formula is a scalar, but a force is a vector"},
        {R"json("loads": [{"type": "potential", "formula": "p"}])json",
         "/loads/0/formula: column 1: the formula is a vector, but a potential is a scalar"},
        {R"json("loads": [{"type": "potential", "formula": "norm(w)"}])json", "the potential depends on a velocity"},
        {R"json("loads": [{"type": "torque", "formula": "w"}])json",
         "/loads/0/frame: is missing; give \"body\" or \"world\""},
        {R"json("loads": [{"type": "torque", "frame": "body", "formula": "w", "vector": [1, 2, 3]}])json",
         "/loads/0/vector: is given together with \"formula\""},
        {R"json("loads": [{"type": "force", "frame": "body", "formula": "v", "point_frame": "world"}])json",
         "/loads/0/point_frame: is given without \"point\""},
        {R"json("loads": [{"type": "motor", "joint": "a", "formula": "1"}])json",
         "is a motor, but the scene has one body"},
        {R"json("loads": [{"type": "torque", "frame": "body", "formula": ["1", "2"]}])json",
         "/loads/0/formula: is an array of length 2; give one formula, or a list of three"},
        {R"json("parameters": {"w": 1})json", "/parameters: the name \"w\" has a meaning in formulas"},
        {R"json("parameters": {"2k": 1})json", "/parameters: the name \"2k\" is not an identifier"},
        {R"json("parameters": {"k": 1}, "let": {"k": "2"})json", "/let: the name \"k\" is given twice"},
        {R"json("let": {"a": "b", "b": "1"})json", "/let/a: column 1: unknown name \"b\""},
        {R"json("let": {"a": "1 +"})json", "/let/a: column 4: the formula ends where a value is expected"},
        {R"json("tables": {"f": {"x": [0, 1], "y": [1]}})json", "/tables/f/y: has 1 numbers, but x has 2"},
        {R"json("tables": {"f": {"x": [0], "y": [1]}})json", "/tables/f/x: has 1 numbers"},
        {R"json("tables": {"f": {"x": [0, 0], "y": [1, 2]}})json", "/tables/f/x/1: is 0, not above the previous x = 0"},
        {R"json("tables": {"f": {"x": [0, 1], "y": [1, 2], "between": "spline"}})json", "give \"linear\" or \"cubic\""},
    };
    for (const BadScene& one : cases)
        EXPECT_NE(fault_of(one.members).find(one.message), std::string::npos) << one.members << "\n"
                                                                              << fault_of(one.members);
}

TEST(FormulaFile, RefusesPlanes) {
    EXPECT_NE(fault_of(R"json("planes": [{"normal": [0, 0, 1], "offset": -5, "restitution": 1}],
                          "loads": [{"type": "force", "frame": "body", "formula": "v"}])json"),
              "no error");
}

}  // namespace
}  // namespace polhode
