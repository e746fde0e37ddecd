#include "report/keyframes.h"

#include <algorithm>
#include <cmath>

#include "body/elementary.h"
#include "body/mass_properties.h"
#include "body/orientation.h"

namespace polhode {
namespace {

// 12 bits and a sign: rounds attitudes by up to half a milliradian, which is invisible
constexpr double grid_steps = 4095;
// finer: a path may be much longer than the body
constexpr double path_steps = 1e6, speed_steps = 32767;

struct Grid {
    double w = 0, p = 0, v = 0;  // grid steps; 0 if all values are zero
    Vector3<double> start;       // origin of positions

    static double rounded(double value, double step) { return step > 0 ? std::round(value / step) * step : 0; }
    static Vector3<double> rounded(const Vector3<double>& v, double step) {
        return {rounded(v[0], step), rounded(v[1], step), rounded(v[2], step)};
    }
    Sample rounded(const Sample& s) const {
        Sample r = s;
        r.q = normalized(Quaternion<double>{rounded(s.q.w, 1 / grid_steps), rounded(s.q.x, 1 / grid_steps),
                                            rounded(s.q.y, 1 / grid_steps), rounded(s.q.z, 1 / grid_steps)});
        r.angular_velocity_B = rounded(s.angular_velocity_B, w);
        r.position_W = start + rounded(s.position_W - start, p);
        r.velocity_W = rounded(s.velocity_W, v);
        return r;
    }
};

double largest(const Vector3<double>& v) { return std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])}); }

Grid grid_of(const SampledMotion& motion, int body) {
    Grid grid;
    if (motion.t.empty()) return grid;
    grid.start = motion.at(0, body).position_W;
    for (std::size_t k = 0; k < motion.t.size(); ++k) {
        const Sample& s = motion.at(k, body);
        grid.w = std::max(grid.w, largest(s.angular_velocity_B) / grid_steps);
        grid.p = std::max(grid.p, largest(s.position_W - grid.start) / path_steps);
        grid.v = std::max(grid.v, largest(s.velocity_W) / speed_steps);
    }
    return grid;
}

// Cubic Hermite polynomial at s in [0, 1] through p with the slopes v at the ends of an interval h.
double hermite(double p0, double v0, double p1, double v1, double h, double s) {
    const double r = s - 1;
    return (1 + 2 * s) * r * r * p0 + s * r * r * h * v0 + s * s * (3 - 2 * s) * p1 + s * s * r * h * v1;
}

Quaternion<double> rate(const Sample& s) {
    const Vector3<double>& w = s.angular_velocity_B;
    const Quaternion<double> d = s.q * Quaternion<double>{0, w[0], w[1], w[2]};
    return {d.w / 2, d.x / 2, d.y / 2, d.z / 2};
}

}  // namespace

bool is_drawable(const Sample& s) {
    const double q = squared_norm(s.q);
    if (!(std::isfinite(q) && q > 1e-30 && q < 1e30)) return false;
    for (int i = 0; i < 3; ++i)
        for (const double value : {s.angular_velocity_B[i], s.position_W[i], s.velocity_W[i]})
            if (!(std::abs(value) < 1e15)) return false;
    return true;
}

Quaternion<double> attitude_between(const Sample& from, const Sample& to, double part) {
    const double h = to.t - from.t;
    const Quaternion<double> a = rate(from), b = rate(to);
    return normalized(
        Quaternion<double>{hermite(from.q.w, a.w, to.q.w, b.w, h, part), hermite(from.q.x, a.x, to.q.x, b.x, h, part),
                           hermite(from.q.y, a.y, to.q.y, b.y, h, part), hermite(from.q.z, a.z, to.q.z, b.z, h, part)});
}

Vector3<double> position_between(const Sample& from, const Sample& to, double part) {
    const double h = to.t - from.t;
    Vector3<double> p;
    for (int i = 0; i < 3; ++i)
        p[i] = hermite(from.position_W[i], from.velocity_W[i], to.position_W[i], to.velocity_W[i], h, part);
    return p;
}

SampledMotion sampled_motion(const Trajectory& trajectory) {
    SampledMotion motion;
    motion.bodies = trajectory.bodies;
    const std::size_t bodies = static_cast<std::size_t>(trajectory.bodies);
    for (std::size_t k = 0; k < trajectory.moments(); ++k) {
        const Bodies at = trajectory.at(k);
        if (!std::ranges::all_of(at, is_drawable)) break;
        motion.t.push_back(at.front().t);
        for (Sample sample : at) {
            sample.q = normalized(sample.q);
            if (motion.samples.size() >= bodies) {
                const Quaternion<double>& before = motion.samples[motion.samples.size() - bodies].q;
                if (before.w * sample.q.w + before.x * sample.q.x + before.y * sample.q.y + before.z * sample.q.z < 0)
                    sample.q = {-sample.q.w, -sample.q.x, -sample.q.y, -sample.q.z};
            }
            motion.samples.push_back(sample);
        }
    }
    return motion;
}

Keyframes select_keyframes(const SampledMotion& motion, const Tolerance& tolerance, bool checked) {
    Keyframes keyframes;
    if (motion.t.empty()) return keyframes;
    std::vector<Grid> grids;
    for (int b = 0; b < motion.bodies; ++b) grids.push_back(grid_of(motion, b));
    // Largest distance of the samples between two keyframes from the interpolation. Unless `to_the_end`, stops at the
    // first sample beyond the tolerance.
    const auto off = [&](std::size_t from, std::size_t to, bool to_the_end = false) {
        Tolerance worst;
        for (int b = 0; b < motion.bodies; ++b) {
            const Grid& grid = grids[static_cast<std::size_t>(b)];
            const Sample begin = grid.rounded(motion.at(from, b)), end = grid.rounded(motion.at(to, b));
            for (std::size_t k = from; k <= to; ++k) {
                const Sample& sample = motion.at(k, b);
                const double part = (sample.t - begin.t) / (end.t - begin.t);
                worst.angle =
                    std::max(worst.angle, rotation_angle_between(sample.q, attitude_between(begin, end, part)));
                worst.length = std::max(worst.length, length(sample.position_W - position_between(begin, end, part)));
                if (!to_the_end && (worst.angle > tolerance.angle || worst.length > tolerance.length)) return worst;
            }
        }
        return worst;
    };
    const auto good = [&](const Tolerance& t) { return t.angle <= tolerance.angle && t.length <= tolerance.length; };
    const std::size_t last = motion.t.size() - 1, stride = checked ? 2 : 1;
    std::size_t from = 0;
    keyframes.at.push_back(0);
    while (from < last) {
        std::size_t to = std::min(from + stride, last), reach = stride;
        Tolerance kept = off(from, to, true);
        // double the interval while it is within the tolerance, then bisect
        while (to < last) {
            const std::size_t further = std::min(from + 2 * reach, last);
            const Tolerance there = off(from, further);
            if (!good(there)) break;
            to = further, reach *= 2, kept = there;
        }
        for (std::size_t more = reach / 2 / stride * stride; more >= stride && to < last;
             more = more / 2 / stride * stride) {
            const std::size_t further = std::min(to + more, last);
            const Tolerance there = off(from, further);
            if (good(there)) to = further, kept = there;
        }
        keyframes.at.push_back(to);
        keyframes.off.angle = std::max(keyframes.off.angle, kept.angle);
        keyframes.off.length = std::max(keyframes.off.length, kept.length);
        from = to;
    }
    return keyframes;
}

Json track_json(const SampledMotion& motion, const Keyframes& keyframes) {
    Json track{{"t", Json::array()}, {"bodies", Json::array()}};
    for (const std::size_t k : keyframes.at) track["t"].push_back(number_json(motion.t[k], 7));
    for (int b = 0; b < motion.bodies; ++b) {
        const Grid grid = grid_of(motion, b);
        Json q = Json::array(), w = Json::array(), p = Json::array(), v = Json::array();
        const auto push = [](Json& list, double value, double step) {
            list.push_back(step > 0 ? std::lround(value / step) : 0L);
        };
        for (const std::size_t k : keyframes.at) {
            const Sample& s = motion.at(k, b);
            for (const double value : {s.q.w, s.q.x, s.q.y, s.q.z}) push(q, value, 1 / grid_steps);
            for (int i = 0; i < 3; ++i) {
                push(w, s.angular_velocity_B[i], grid.w);
                if (!(grid.p > 0)) continue;
                push(p, s.position_W[i] - grid.start[i], grid.p);
                push(v, s.velocity_W[i], grid.v);
            }
        }
        track["bodies"].push_back({{"q", std::move(q)},
                                   {"w", std::move(w)},
                                   {"w_scale", grid.w},
                                   {"p", std::move(p)},
                                   {"v", std::move(v)},
                                   {"p_scale", grid.p},
                                   {"v_scale", grid.v},
                                   {"p_start", vector_json(grid.start)}});
    }
    return track;
}

}  // namespace polhode
