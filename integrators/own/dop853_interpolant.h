// Dense output of order 8 for DOP853.
//
// The interpolant of Hairer, Norsett & Wanner (1993, II.6; contd8 of dop853.f) is a polynomial of degree 7. It uses
// the rate at the end of the step and three additional stages. Its local error is O(h^8), that of the step O(h^9):
// with the step sizes of the error control, samples would have errors up to 20 times larger than the ends of steps.
// Here the interpolant gives only the values at five interior points. The rates at these points have errors O(h^8).
// The polynomial p of degree 8 with
//
//     p(0) = y_0,   p(1) = y_1,   p'(x) = h f(t + x h, y(x)) at x = 0, 1 and the five points
//
// therefore has a local error of O(h^9), as the step has (bootstrapping: Enright, Jackson, Norsett & Thomsen 1986,
// ACM TOMS 12, 193). The points were chosen for a small error and small cardinal polynomials. They are not symmetric
// about 1/2, because an odd number of symmetric points leaves p undetermined: the integral of w_7 below would be 0.
//
// p' is in Newton's form, p' = sum of d_k w_k, w_k(x) = (x - x_0) .. (x - x_(k-1)), with divided differences d_0 ..
// d_6 of the rates and d_7 from p(1) = y_1.
#pragma once

#include <array>

#include "integrators/own/dormand_prince.h"
#include "motion/numbers.h"

namespace polhode {

/// Coefficients of Hairer, Norsett & Wanner's interpolant, from dop853.f. Stage 13 is the rate at the end of the
/// step. Columns are the 12 stages of the step, stage 13 and the previous additional stages.
struct Dop853DenseTableau {
    static constexpr int added = 3;  ///< stages 14 to 16
    static constexpr int stages = dop853_stages + 1 + added;
    double c[added] = {0.1, 0.2, 7.0 / 9};
    double a[added][stages] = {
        {5.61675022830479523392909219681e-2, 0, 0, 0, 0, 0, 2.53500210216624811088794765333e-1,
         -2.46239037470802489917441475441e-1, -1.24191423263816360469010140626e-1, 1.5329179827876569731206322685e-1,
         8.20105229563468988491666602057e-3, 7.56789766054569976138603589584e-3, -8.298e-3},
        {3.18346481635021405060768473261e-2, 0, 0, 0, 0, 2.83009096723667755288322961402e-2,
         5.35419883074385676223797384372e-2, -5.49237485713909884646569340306e-2, 0, 0,
         -1.08347328697249322858509316994e-4, 3.82571090835658412954920192323e-4, -3.40465008687404560802977114492e-4,
         1.41312443674632500278074618366e-1},
        {-4.28896301583791923408573538692e-1, 0, 0, 0, 0, -4.69762141536116384314449447206,
         7.68342119606259904184240953878, 4.06898981839711007970213554331, 3.56727187455281109270669543021e-1, 0, 0, 0,
         -1.39902416515901462129418009734e-3, 2.9475147891527723389556272149, -9.15095847217987001081870187138}};
    double d[4][stages] = {
        {-8.4289382761090128651353491142, 0, 0, 0, 0, 0.56671495351937776962531783590, -3.0689499459498916912797304727,
         2.3846676565120698287728149680, 2.1170345824450282767155149946, -0.87139158377797299206789907490,
         2.2404374302607882758541771650, 0.63157877876946881815570249290, -0.088990336451333310820698117400,
         18.148505520854727256656404962, -9.1946323924783554000451984436, -4.4360363875948939664310572000},
        {10.427508642579134603413151009, 0, 0, 0, 0, 242.28349177525818288430175319, 165.20045171727028198505394887,
         -374.54675472269020279518312152, -22.113666853125306036270938578, 7.7334326684722638389603898808,
         -30.674084731089398182061213626, -9.3321305264302278729567221706, 15.697238121770843886131091075,
         -31.139403219565177677282850411, -9.3529243588444783865713862664, 35.816841486394083752465898540},
        {19.985053242002433820987653617, 0, 0, 0, 0, -387.03730874935176555105901742, -189.17813819516756882830838328,
         527.80815920542364900561016686, -11.573902539959630126141871134, 6.8812326946963000169666922661,
         -1.0006050966910838403183860980, 0.77771377980534432092869265740, -2.7782057523535084065932004339,
         -60.196695231264120758267380846, 84.320405506677161018159903784, 11.992291136182789328035130030},
        {-25.693933462703749003312586129, 0, 0, 0, 0, -154.18974869023643374053993627, -231.52937917604549567536039109,
         357.63911791061412378285349910, 93.405324183624310003907691704, -37.458323136451633156875139351,
         104.09964950896230045147246184, 29.840293426660503123344363579, -43.533456590011143754432175058,
         96.324553959188282948394950600, -39.177261675615439165231486172, -149.72683625798562581422125276}};
};
inline constexpr Dop853DenseTableau dop853_dense;

/// Change of the state since the start of a step, at any time inside the step.
template <class Values>
class Dop853Interpolant {
  public:
    /// Right-hand sides that form() evaluates: one at the end of the step, three stages and five at interior points.
    static constexpr int evaluations = 9;

    /// For states with `size` components.
    explicit Dop853Interpolant(int size) : size_(size), differences_(copies_of<terms>(Values(size))) {}

    /// Forms the interpolant of a step from y at t to y + change at t + h (s). `k` are the rates of the step's
    /// stages.
    template <class SystemType, class Stages>
    void form(const SystemType& system, double t, double h, const double* y, const Values& change, const Stages& k) {
        constexpr int step_stages = dop853_stages, added = Dop853DenseTableau::added;
        std::array<Values, 1 + added> more = copies_of<1 + added>(Values(size_));  // stages 13 to 16
        Values at(size_);
        const auto weighted = [&](const double* weights, int count, int i) {
            double sum = 0;
            for (int j = 0; j < count; ++j)
                if (weights[j] != 0) sum += weights[j] * (j < step_stages ? k[j][i] : more[j - step_stages][i]);
            return sum;
        };
        for (int i = 0; i < size_; ++i) at[i] = y[i] + change[i];
        system.derivative(t + h, at.data(), more[0].data());
        for (int s = 0; s < added; ++s) {
            for (int i = 0; i < size_; ++i) at[i] = y[i] + h * weighted(dop853_dense.a[s], step_stages + 1 + s, i);
            system.derivative(t + dop853_dense.c[s] * h, at.data(), more[1 + s].data());
        }
        // x (f_0 + (1 - x) (f_1 + x (f_2 + ..)))
        constexpr int degree = 7;
        std::array<Values, degree> nested = copies_of<degree>(Values(size_));
        for (int i = 0; i < size_; ++i) {
            nested[0][i] = change[i];
            nested[1][i] = h * k[0][i] - change[i];
            nested[2][i] = change[i] - h * more[0][i] - nested[1][i];
            for (int m = 0; m < 4; ++m)
                nested[3 + m][i] = h * weighted(dop853_dense.d[m], Dop853DenseTableau::stages, i);
        }
        for (int i = 0; i < size_; ++i) differences_[0][i] = h * k[0][i], differences_[1][i] = h * more[0][i];
        for (int point = 2; point < rates; ++point) {
            const double x = points[point];
            for (int i = 0; i < size_; ++i) {
                double sum = 0;
                for (int m = degree - 1; m >= 0; --m) sum = (sum + nested[m][i]) * (m % 2 == 0 ? x : 1 - x);
                at[i] = y[i] + sum;
            }
            Values& rate = differences_[point];
            system.derivative(t + x * h, at.data(), rate.data());
            for (int i = 0; i < size_; ++i) rate[i] *= h;
        }
        for (int order = 1; order < rates; ++order)
            for (int point = rates - 1; point >= order; --point)
                for (int i = 0; i < size_; ++i)
                    differences_[point][i] =
                        (differences_[point][i] - differences_[point - 1][i]) / (points[point] - points[point - order]);
        const std::array<double, terms> at_end = integrals(1);
        for (int i = 0; i < size_; ++i) {
            double rest = change[i];
            for (int m = 0; m < rates; ++m) rest -= differences_[m][i] * at_end[m];
            differences_[rates][i] = rest / at_end[rates];
        }
    }

    /// p(x) - p(0), where x goes from 0 at the start of the step to 1 at its end.
    Values change(double x) const {
        const std::array<double, terms> at = integrals(x);
        Values sum(size_);
        for (int i = 0; i < size_; ++i) {
            sum[i] = 0;
            for (int m = terms - 1; m >= 0; --m) sum[i] += differences_[m][i] * at[m];
        }
        return sum;
    }

  private:
    static constexpr int rates = 7, terms = rates + 1;
    static constexpr double points[rates] = {0, 1, 0.38, 0.78, 0.1, 0.9, 0.26};

    using Polynomials = std::array<std::array<double, terms>, terms>;
    /// Coefficients of the integrals of w_k from 0 to x, divided by x.
    static constexpr Polynomials coefficients() {
        Polynomials w{};
        w[0][0] = 1;
        for (int k = 1; k < terms; ++k)
            for (int m = k; m >= 0; --m) w[k][m] = (m > 0 ? w[k - 1][m - 1] : 0) - points[k - 1] * w[k - 1][m];
        for (int k = 0; k < terms; ++k)
            for (int m = 0; m < terms; ++m) w[k][m] /= m + 1;
        return w;
    }
    static std::array<double, terms> integrals(double x) {
        static constexpr Polynomials integrated = coefficients();
        std::array<double, terms> values{};
        for (int k = 0; k < terms; ++k) {
            for (int m = k; m >= 0; --m) values[k] = values[k] * x + integrated[k][m];
            values[k] *= x;
        }
        return values;
    }

    int size_;
    std::array<Values, terms> differences_;
};

}  // namespace polhode
