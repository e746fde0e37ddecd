#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>

#include "experiment/kinds/stability.h"

namespace polhode {
namespace {

// The error of a step across a jump is proportional to h, across a jump of the derivative to h^2. This limits the order
// of a method of higher order. A jump at a symmetric point of the step may cause a smaller error.
TEST(Discontinuities, CostTheOrderOfMethodsThatStepOverThem) {
    const Table table = measure_discontinuities(true).table;
    const auto column = [&](const char* name) { return column_index(table, name); };
    std::map<std::string, double> orders, errors;
    for (const std::vector<Cell>& row : table.rows) {
        EXPECT_EQ(text_of(row[column("status")]), "ok");
        const std::string key =
            text_of(row[column("case")]) + "/" + text_of(row[column("method")]) + "/" + text_of(row[column("stepped")]);
        const std::string order = text_of(row[column("observed_order")]);
        if (!order.empty()) orders[key] = std::stod(order);
        errors[key] = std::stod(text_of(row[column("error_at_finest")]));
    }
    for (const char* method : {"odeint_rk4", "munthe_kaas4"}) {
        for (const char* what : {"torque jumps", "torque derivative jumps", "pulse shorter than a step"})
            EXPECT_NEAR(orders.at(std::string(what) + "/" + method + "/onto"), 4, 0.3) << what;
        EXPECT_NEAR(orders.at(std::string("torque jumps/") + method + "/over"), 1, 0.15);
        // every step misses the pulse, so the error does not converge
        const std::string missed = std::string("pulse shorter than a step/") + method + "/over";
        EXPECT_GT(errors.at(missed), 0.1);
        EXPECT_FALSE(orders.contains(missed));
    }
    EXPECT_NEAR(orders.at("torque jumps/odeint_fehlberg78/over"), 1, 0.3);
    EXPECT_NEAR(orders.at("torque derivative jumps/odeint_fehlberg78/over"), 2, 0.3);
    for (const char* method : {"dop853", "extrapolation", "cvode_adams"}) {
        EXPECT_LT(errors.at(std::string("pulse shorter than a step/") + method + "/onto"), 1e-6);
        EXPECT_LT(errors.at(std::string("torque jumps/") + method + "/onto"), 1e-6);
    }
}

}  // namespace
}  // namespace polhode
