#include "motion/finer_frame.h"

#include <algorithm>
#include <boost/multiprecision/cpp_bin_float.hpp>

#include "body/principal_rotation.h"
#include "motion/exact_body_of.h"

namespace polhode {
namespace {

using Many = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<120>, boost::multiprecision::et_off>;

// Converts to 113 bits as the sum of binary64 numbers.
Wide wide(const Many& x) {
    const double high = x.convert_to<double>();
    const Many rest = x - high;
    const double middle = rest.convert_to<double>();
    return Wide(high) + (Wide(middle) + Wide(Many(rest - middle).convert_to<double>()));
}
Vector3<Wide> wide(const Vector3<Many>& v) { return {wide(v[0]), wide(v[1]), wide(v[2])}; }

}  // namespace

bool needs_finer_frame(const Matrix3<Wide>& inertia, bool moved, const Vector3<double>& moments) {
    constexpr double small = 1e-10;
    bool axes_are_found = false;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < i; ++j) axes_are_found = axes_are_found || inertia[i][j] != 0;
    const double least = std::min({moments[0], moments[1], moments[2]});
    return (moved || axes_are_found) && !(least > small * std::max({moments[0], moments[1], moments[2]}));
}

FinerFrame finer_frame(const Scene& scene) {
    const ExactBody<Many> body = exact_body<Many>(scene);
    Matrix3<Many> a = body.inertia_B;
    const Quaternion<Many> q = rotate_to_principal_axes(a, 1e130);
    FinerFrame frame;
    frame.wide = {wide({a[0][0], a[1][1], a[2][2]}), {wide(q.w), wide(q.x), wide(q.y), wide(q.z)}};
    frame.nearest = rounded(frame.wide);
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        // the difference of moments that may agree in 113 bits
        frame.nearest.gyroscopic[i] = Many((a[j][j] - a[k][k]) / a[i][i]).convert_to<double>();
    }
    const Matrix3<Many> inverse_inertia = inverse(body.inertia_B);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) frame.inverse_inertia[i][j] = inverse_inertia[i][j].convert_to<double>();
    frame.angular_velocity_B = wide(rotate_back(q, body.angular_velocity_B));
    return frame;
}

}  // namespace polhode
