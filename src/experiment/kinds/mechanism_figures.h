// Published numbers for mechanism scenes, numbers from independent equations, and how both map to polhode's scenes.
#pragma once

#include <array>

namespace polhode::figures {

// Andrews' squeezing mechanism at t = 0.03 s: mechanisms/andrews_squeezer
//
// The seven angles of the source are the joint coordinates of the scene, with the same signs, in the order beta, theta,
// gamma, phi, delta, omega, epsilon (not the order of the scene file). The plane of the source is z = 0; its angles
// rotate from x to y, about +z, and are not wrapped. Attitudes of the bodies, as angles about +z from the world's axes
// (rates have the same sums):
//   K1 beta, K2 beta + theta, K3 gamma, K4 phi + delta, K5 delta, K6 omega + epsilon, K7 epsilon
// The source's equations are M q'' = f - G^T lambda. The rows of g = 0 are x and y of the point E on K2 minus E on K3,
// minus E on K4, minus E on K6. Therefore (lambda_1, lambda_2, 0) N is the force of K2 on K3 in the loop E3,
// (lambda_3, lambda_4, 0) of K2 on K4 in E4, and (lambda_5, lambda_6, 0) of K2 on K6 in E6. These are polhode's
// reactions of the loops, whose first body is K2. The point E carries no torque.

/// The joints in the order of the numbers below.
inline constexpr std::array<const char*, 7> andrews_joints{"beta",  "theta", "gamma",  "phi",
                                                           "delta", "omega", "epsilon"};
/// The bodies, and the joint angles or rates whose sum is the body's angle or rate about z.
struct AndrewsBody {
    const char* name;
    std::array<int, 2> parts;  ///< indices into andrews_joints; the second is -1 if there is only one
};
inline constexpr std::array<AndrewsBody, 7> andrews_bodies{{{"K1", {0, -1}},
                                                            {"K2", {0, 1}},
                                                            {"K3", {2, -1}},
                                                            {"K4", {3, 4}},
                                                            {"K5", {4, -1}},
                                                            {"K6", {5, 6}},
                                                            {"K7", {6, -1}}}};
/// The loops in the order of the multipliers. Each has two multipliers, x and y of the force.
inline constexpr std::array<const char*, 3> andrews_loops{"E3", "E4", "E6"};

struct AndrewsFigures {
    std::array<double, 7> angles;         ///< rad
    std::array<double, 7> rates;          ///< rad/s
    std::array<double, 7> accelerations;  ///< rad/s^2
    std::array<double, 6> multipliers;    ///< N
};

/// F. Mazzia and C. Magherini 2008, Test Set for Initial Value Problem Solvers, release 2.4, problem Andrews' squeezing
/// mechanism: reference solution by PSIDE on a Cray C90, tolerances 1e-14. Of the 16 digits printed, 9 to 12 are
/// correct in the angles (largest relative error 2.7e-10, gamma), 7 to 10 in the rates, 6 to 7 in the multipliers
/// (largest relative error 1.3e-6, lambda_6), compared with andrews_recomputed.
inline constexpr AndrewsFigures andrews_published{
    {0.1581077119629904e2, -0.1575637105984298e2, 0.4082224013073101e-1, -0.5347301163226948, 0.5244099658805304,
     0.5347301163226948, 0.1048080741042263e1},
    {0.1139920302151208e4, -0.1424379294994111e4, 0.1103291221937134e2, 0.1929337464421385e2, 0.5735699284790808,
     -0.1929337464421385e2, 0.3231791658026955},
    {-0.2463176316945196e5, 0.5185037701610329e5, 0.3241025686413781e6, 0.5667493645176213e6, 0.1674362929479361e5,
     -0.5667493645176222e6, 0.9826520791458422e4},
    {0.1991753333731910e3, -0.2975531228015052e2, 0.2306654119098399e2, 0.3145271365475927e2, 0.2264249232082739e2,
     0.1161740700019673e2}};

struct AndrewsDecimals {
    std::array<const char*, 7> angles;         ///< rad
    std::array<const char*, 7> rates;          ///< rad/s
    std::array<const char*, 7> accelerations;  ///< rad/s^2
    std::array<const char*, 6> multipliers;    ///< N
};

/// The equations of the source (seven angles, six multipliers, second derivative of g = 0 instead of g), solved in
/// 32 digits by Gragg-Bulirsch-Stoer extrapolation of ten columns in 300 steps. The start has theta = 0 and satisfies
/// the constraints; the parameters are the binary64 numbers of the scene file. At the end |g| < 5e-30. Eight columns in
/// 200 steps agree to 20 digits in the angles and 18 in the rest. With the source's decimal numbers instead of binary64
/// the angles change by at most 3e-15 rad, the rates by at most 1e-12 rad/s.
inline constexpr AndrewsDecimals andrews_recomputed{
    {"15.8107711951537087484", "-15.75637105841184149187", "0.04082224011964580843621", "-0.5347301163420796919865",
     "0.5244099658799540311933", "0.5347301163420796919865", "1.048080741041937836165"},
    {"1139.920302259106149498", "-1424.379295177540149246", "11.03291191061905421375", "19.29337410503284748175",
     "0.5735699148295280367234", "-19.29337410503284748175", "0.3231791492491437584702"},
    {"-24631.763122876244886", "51850.319636466737263", "324102.60070757856365", "566749.42200099529351",
     "16743.635418345481848", "-566749.42200099529351", "9826.5078015441715435"},
    {"199.17534810453863254", "-29.755309974971947709", "23.066543611622154801", "31.45272527577120466",
     "22.642494786394376697", "11.617392352611266941"}};

/// The initial angles of the source to 30 digits, and the initial accelerations and multipliers that are not zero.
inline constexpr std::array<const char*, 7> andrews_start{
    "-0.0617138900142764496358948458001", "0",
    "0.455279819163070380255912382449",   "0.222668390165885884674473185609",
    "0.487364979543842550225598953530",   "-0.222668390165885884674473185609",
    "1.23054744454982119249735015568"};
inline constexpr const char* andrews_start_beta_acceleration = "14222.4439199541138705911625887";    ///< rad/s^2
inline constexpr const char* andrews_start_theta_acceleration = "-10666.8329399655854029433719415";  ///< rad/s^2
inline constexpr const char* andrews_start_lambda_1 = "98.5668703962410896057654982170";             ///< N
inline constexpr const char* andrews_start_lambda_2 = "-6.12268834425566265503114393122";            ///< N

// Kane's babyboot at t = 10 s: mechanisms/babyboot
//
// q_A is the coordinate of the joint hinge, q_B of swivel; neither is wrapped. The attitude of the rod is exp(x q_A),
// of the plate exp(x q_A) exp(z q_B). The angular velocity of the rod is (q_A', 0, 0) in rod and in world axes, of the
// plate (q_A' cos q_B, -q_A' sin q_B, q_B') in plate axes. Energy is zero at the height of the hinge: E = 0 at the
// start.

struct BabybootFigures {
    double q_A, q_B;  ///< degrees
    double rate_A;    ///< rad/s
    double rate_B;    ///< rad/s
    double accel_A;   ///< rad/s^2
    double accel_B;   ///< rad/s^2
};

/// Drake, multibody/benchmarks/chaotic_babyboot/MG/test/MG_chaotic_babyboot_test.cc (P. Mitiguy 2017): the expected
/// values of its Kutta-Merson integration, with tolerances of 1e2 to 1e4 times 1e-12. The error of q_B' is 6.6e-7
/// rad/s.
inline constexpr BabybootFigures babyboot_expected{-61.312983340691, -929.47789677244, -6.7440081040646,
                                                   -2.7795690128833, 41.137023263571,  19.483647096003};
/// Other runs documented in the same file: two by Kutta-Merson with other tolerances, and one by MATLAB's ode45.
inline constexpr BabybootFigures babyboot_simulation_a{-61.312983517329, -929.47789818494, -6.7440080750248,
                                                       -2.7795696971631, 41.137023170384,  19.483647506439};
inline constexpr BabybootFigures babyboot_simulation_b{-61.312983761859, -929.47789795831, -6.7440080514955,
                                                       -2.7795695154087, 41.137023317160,  19.483647277708};
inline constexpr BabybootFigures babyboot_ode45{-61.3129818234, -929.477885053, -6.74400835033,
                                                -2.77956334901, 41.1370240118,  19.4836437213};

/// q_A, q_B (rad), q_A', q_B' (rad/s) by the two equations in the comment of the scene file, with Taylor series of
/// order 40 in 40 digits and the binary64 numbers of the scene file. 500 and 800 steps agree in all digits shown.
inline constexpr std::array<const char*, 4> babyboot_recomputed{
    "-1.07011343660372181987659788191", "-16.2224496470249062784529182656", "-6.74400807535235832636357492305",
    "-2.77956967280267151318789044636"};

// The double four-bar at t = 10 s: mechanisms/double_four_bar over ten times its duration
//
// The upper end of upright_0, (x, z) in world axes; in the source y is up. The motion is a pendulum's, 3 a'' = 3.5 *
// 9.81 sin a from a = 0, a' = 1 (with 1/12 kg m^2 per rod): x = sin a, z = cos a, one revolution in 1.94251492260708 s.

struct FourBarFigures {
    double x, z;    ///< m
    double vx, vz;  ///< m/s
};

/// Exudyn's TestModels/fourBarMechanismIftomm.py (J. Gerstmayr 2021), generalized alpha at h = 1.25e-4 s. Errors: 7e-7
/// m and 1.5e-6 m/s.
inline constexpr FourBarFigures double_four_bar_exudyn{0.3284573768, 0.9445187937, 1.423050003, -0.4948670827};
/// By quadrature of the pendulum equation.
inline constexpr FourBarFigures double_four_bar_quadrature{0.328458111540815, 0.944518538178601, 1.42305147020694,
                                                           -0.494868845487043};

}  // namespace polhode::figures
