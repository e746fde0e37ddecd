// DOP853: Dormand & Prince's method of order 8 with the error estimates of orders 5 and 3 by Hairer, Norsett & Wanner
// (1993), Solving Ordinary Differential Equations I, II.5 and II.10. The coefficients are those of their code
// dop853.f.
#pragma once

#include "integrators/lanes/rotation_lanes.h"

namespace polhode {

inline constexpr int dop853_stages = 12;

/// Coefficients of the 12 stages.
struct Dop853Tableau {
    double c[dop853_stages] = {0,
                               0.526001519587677318785587544488e-1,
                               0.789002279381515978178381316732e-1,
                               0.118350341907227396726757197510,
                               0.281649658092772603273242802490,
                               1.0 / 3,
                               0.25,
                               4.0 / 13,
                               127.0 / 195,
                               0.6,
                               6.0 / 7,
                               1};
    double a[dop853_stages][dop853_stages] = {
        {},
        {5.26001519587677318785587544488e-2},
        {1.97250569845378994544595329183e-2, 5.91751709536136983633785987549e-2},
        {2.95875854768068491816892993775e-2, 0, 8.87627564304205475450678981324e-2},
        {2.41365134159266685502369798665e-1, 0, -8.84549479328286085344864962717e-1,
         9.24834003261792003115737966543e-1},
        {3.7037037037037037037037037037e-2, 0, 0, 1.70828608729473871279604482173e-1,
         1.25467687566822425016691814123e-1},
        {3.7109375e-2, 0, 0, 1.70252211019544039314978060272e-1, 6.02165389804559606850219397283e-2, -1.7578125e-2},
        {3.70920001185047927108779319836e-2, 0, 0, 1.70383925712239993810214054705e-1,
         1.07262030446373284651809199168e-1, -1.53194377486244017527936158236e-2, 8.27378916381402288758473766002e-3},
        {6.24110958716075717114429577812e-1, 0, 0, -3.36089262944694129406857109825,
         -8.68219346841726006818189891453e-1, 2.75920996994467083049415600797e1, 2.01540675504778934086186788979e1,
         -4.34898841810699588477366255144e1},
        {4.77662536438264365890433908527e-1, 0, 0, -2.48811461997166764192642586468,
         -5.90290826836842996371446475743e-1, 2.12300514481811942347288949897e1, 1.52792336328824235832596922938e1,
         -3.32882109689848629194453265587e1, -2.03312017085086261358222928593e-2},
        {-9.3714243008598732571704021658e-1, 0, 0, 5.18637242884406370830023853209, 1.09143734899672957818500254654,
         -8.14978701074692612513997267357, -1.85200656599969598641566180701e1, 2.27394870993505042818970056734e1,
         2.49360555267965238987089396762, -3.0467644718982195003823669022},
        {2.27331014751653820792359768449, 0, 0, -1.05344954667372501984066689879e1, -2.00087205822486249909675718444,
         -1.79589318631187989172765950534e1, 2.79488845294199600508499808837e1, -2.85899827713502369474065508674,
         -8.87285693353062954433549289258, 1.23605671757943030647266201528e1, 6.43392746015763530355970484046e-1}};
    double b[dop853_stages] = {5.42937341165687622380535766363e-2,
                               0,
                               0,
                               0,
                               0,
                               4.45031289275240888144113950566,
                               1.89151789931450038304281599044,
                               -5.8012039600105847814672114227,
                               3.1116436695781989440891606237e-1,
                               -1.52160949662516078556178806805e-1,
                               2.01365400804030348374776537501e-1,
                               4.47106157277725905176885569043e-2};
    /// Weights of the embedded method of order 3, which uses stages 1, 9 and 12.
    double third[dop853_stages] = {
        0.244094488188976377952755905512,   0, 0, 0, 0, 0, 0, 0, 0.733846688281611857341361741547, 0, 0,
        0.220588235294117647058823529412e-1};
    /// Weights minus those of the embedded method of order 5.
    double fifth_error[dop853_stages] = {0.1312004499419488073250102996e-1,
                                         0,
                                         0,
                                         0,
                                         0,
                                         -0.1225156446376204440720569753e1,
                                         -0.4957589496572501915214079952,
                                         0.1664377182454986536961530415e1,
                                         -0.3503288487499736816886487290,
                                         0.3341791187130174790297318841,
                                         0.8192320648511571246570742613e-1,
                                         -0.2235530786388629525884427845e-1};
};
inline constexpr Dop853Tableau dop853;

/// Result of a step, with the rates of its stages.
struct Dop853RotationStep : RotationStep {
    alignas(64) double rates[dop853_stages][8];
};

/// One step in a register. `squared_error` and `squared_error_before` come from the estimates of order 5 and 3.
template <RotationTerms terms, class Register>
POLHODE_INLINE void dop853_step(const RotationCoefficients& coefficients, const RotationAllowance& allowance,
                                const RotationState& from, double h, Dop853RotationStep& to) {
    const RotationRate<terms, Register> rate(coefficients);
    const Register y = loaded<Register>(from.y), zero = broadcast<Register>(0), step = broadcast<Register>(h);
    Register k[dop853_stages];
    const auto weighted = [&](auto count, const double* weights) POLHODE_INLINE_LAMBDA {
        Register sum = zero;
        unrolled<count>([&](auto j) POLHODE_INLINE_LAMBDA {
            if (weights[j] != 0) sum = sum + broadcast<Register>(weights[j]) * k[j];
        });
        return sum;
    };
    unrolled<dop853_stages>([&](auto i) POLHODE_INLINE_LAMBDA {
        if constexpr (i == 0) {
            k[i] = rate(y);
        } else {
            k[i] = rate(y + step * weighted(i, dop853.a[i]));
        }
        store(to.rates[i], k[i]);
    });
    constexpr std::integral_constant<int, dop853_stages> all;
    const Register slope = weighted(all, dop853.b), change = step * slope;
    const Register fifth = step * weighted(all, dop853.fifth_error);
    const Register third = step * (slope - weighted(all, dop853.third));
    const Register slack = broadcast<Register>(allowance.rounding) * change;
    const Register allowed = loaded<Register>(allowance.squared_scale) + slack * slack;
    to.squared_error = squared_norm(fifth, allowed);
    to.squared_error_before = squared_norm(third, allowed);
    const Register increment = change + loaded<Register>(from.lost), next = y + increment;
    store(to.state.y, next);
    store(to.state.lost, rounded_away(y, increment, next));
}

using Dop853Step = void(const RotationCoefficients&, const RotationAllowance&, const RotationState&, double h,
                        Dop853RotationStep& to);
/// One step, compiled for each instruction set. All give the same bits.
Dop853Step dop853_step_plain, dop853_step_avx2, dop853_step_avx512;
/// Returns the step function for an instruction set that the processor supports.
Dop853Step* dop853_step(InstructionSet set);

}  // namespace polhode
