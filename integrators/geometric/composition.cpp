#include "integrators/geometric/composition.h"

namespace polhode {
namespace {

constexpr double order_2[] = {1};

constexpr double suzuki = 0.41449077179437573714;  // 1/(4 - 4^(1/3))
constexpr double order_4[] = {suzuki, suzuki, 1 - 4 * suzuki, suzuki, suzuki};

constexpr double kahan_li_6[] = {0.39216144400731413928, 0.33259913678935943860, -0.70624617255763935981,
                                 0.082213596293550800230, 0.79854399093482996340};
constexpr double order_6[] = {kahan_li_6[0], kahan_li_6[1], kahan_li_6[2], kahan_li_6[3], kahan_li_6[4],
                              kahan_li_6[3], kahan_li_6[2], kahan_li_6[1], kahan_li_6[0]};

constexpr double kahan_li_8[] = {0.13020248308889008088, 0.56116298177510838456,  -0.38947496264484728641,
                                 0.15884190655515560090, -0.39590389413323757734, 0.18453964097831570709,
                                 0.25837438768632204729, 0.29501172360931029887,  -0.60550853383003451170};
constexpr double order_8[] = {kahan_li_8[0], kahan_li_8[1], kahan_li_8[2], kahan_li_8[3], kahan_li_8[4], kahan_li_8[5],
                              kahan_li_8[6], kahan_li_8[7], kahan_li_8[8], kahan_li_8[7], kahan_li_8[6], kahan_li_8[5],
                              kahan_li_8[4], kahan_li_8[3], kahan_li_8[2], kahan_li_8[1], kahan_li_8[0]};

}  // namespace

std::span<const double> composition(int order) {
    constexpr std::span<const double> all[] = {order_2, order_4, order_6, order_8};
    return order < 2 || order > 8 || order % 2 != 0 ? std::span<const double>() : all[order / 2 - 1];
}

}  // namespace polhode
