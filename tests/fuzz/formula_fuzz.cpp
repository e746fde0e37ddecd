// Fuzzes the parser of formulas. A formula is refused with a column inside it, or it is an expression that evaluates,
// differentiates, and gives the same operations when it is parsed again.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "formula/formula_values.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string text(reinterpret_cast<const char*>(data), size);
    polhode::test::FormulaFixture fixture;
    fixture.scope.tables["f"] = {{0, 1, 2}, {1, 3, 2}, true};
    try {
        const polhode::formula::Value value = fixture.parse(text);
        const std::size_t operations = fixture.expression.nodes().size();
        if (fixture.parse(text).component != value.component) std::abort();
        if (fixture.expression.nodes().size() != operations) std::abort();
        fixture.values<double>({value.component[0]}, {0.5, 1, -2, 1, 0, 0, 0});
        fixture.expression.differentiate(value.component[0], {0, 1, 2});
    } catch (const polhode::formula::FormulaError& error) {
        if (error.column() < 1 || error.column() > size + 1) std::abort();
        if (error.remedy().empty() || *error.what() == '\0') std::abort();
    } catch (const polhode::formula::LimitError&) {
    }
    return 0;
}
