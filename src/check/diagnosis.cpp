#include "check/diagnosis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "body/orientation.h"
#include "check/attitude_update.h"
#include "check/convention.h"
#include "motion/exact_body.h"

namespace polhode {
namespace {

// below this a file is as the scene has it (rad, or relative)
constexpr double plain_error = 1e-4;
// How many times nearer a hypothesis must lie than the scene; more where a number is fitted to the file: a method's own
// dissipation or slowness has been seen described to a thirtieth by a damping, to an eighteenth by another time step.
constexpr double factor = 10, fitted_factor = 50;
// a hypothesis this many times worse than the best says nothing more
constexpr double dominated = 5;
// what is explained to this part of the error is explained: of two that do, the one found first stands first
constexpr double same = 1e-3;
// A w that is further than this from the one predicted, and so many times further than from another, speaks against the
// prediction. Steps, grids and a first row from before the fault leave less.
constexpr double plain_rates = 0.05, rates_factor = 3;
constexpr double degree = std::numbers::pi / 180;
constexpr double unfit = 10;  // rad: no motion to compare with

double length(const Vector3<double>& v) { return std::sqrt(dot(v, v)); }

Vector3<double> world_rate(const Sample& sample) {
    return (1 / squared_norm(sample.q)) * rotate(sample.q, sample.angular_velocity_B);
}

template <class Error>
double root_mean_square(std::size_t count, Error&& error) {
    double sum = 0;
    for (std::size_t k = 0; k < count; ++k) {
        const double e = error(k);
        sum += e * e;
    }
    return std::sqrt(sum / static_cast<double>(count));
}

// The least of f on a grid of at least three, refined between the neighbours of its best point (golden section).
template <class F>
std::pair<double, double> least(const F& f, const std::vector<double>& grid) {
    std::size_t best = 0;
    std::vector<double> values;
    for (const double x : grid) values.push_back(f(x));
    for (std::size_t i = 1; i < grid.size(); ++i)
        if (values[i] < values[best]) best = i;
    double a = grid[best > 0 ? best - 1 : 0], b = grid[std::min(best + 1, grid.size() - 1)];
    const double ratio = (std::sqrt(5.0) - 1) / 2;
    double x = b - ratio * (b - a), y = a + ratio * (b - a), fx = f(x), fy = f(y);
    for (int i = 0; i < 20; ++i) {
        if (fx < fy)
            b = y, y = x, fy = fx, x = b - ratio * (b - a), fx = f(x);
        else
            a = x, x = y, fx = fy, y = a + ratio * (b - a), fy = f(y);
    }
    std::pair<double, double> result{grid[best], values[best]};
    if (fx < result.second) result = {x, fx};
    if (fy < result.second) result = {y, fy};
    return result;
}

// what a diagnosis is about: only those of one kind compete
enum class About { attitude, rate, position };

// what is known of a hypothesis beside what it explains
struct Evidence {
    std::string convention = "";                             // that would mend the file
    bool fitted = false;                                     // a number of it was fitted to the file
    std::function<std::optional<double>()> rates_left = {};  // asked only of what explains the file
};

struct Found {
    About about;
    Diagnosis diagnosis;
    bool fitted = false;
    std::optional<double> rates_left = std::nullopt;  // how far the file's w is from the one predicted, relative
};

class Examination {
  public:
    Examination(const Scene& scene, const TrajectoryFile& file, const AlteredMotion& motion)
        : scene_(&scene), file_(&file), motion_(&motion) {}

    std::vector<Diagnosis> diagnoses() {
        if (!choose_rows()) return {};
        find_in_rates();
        find_in_positions();
        if (attitude_error_ > plain_error) {
            find_conventions();
            find_first_order_update();
            find_wrong_time();
            find_alterations();
            find_other_scenes();
        }
        return ranked();
    }

  private:
    const Scene* scene_;
    const TrajectoryFile* file_;
    const AlteredMotion* motion_;
    std::vector<std::size_t> index_;  // of the rows compared
    std::vector<double> times_;
    std::vector<Sample> own_;  // the scene's motion at them
    double attitude_error_ = 0, turned_ = 0;
    std::vector<Found> found_;

    const TrajectoryRow& row(std::size_t k) const { return file_->rows[index_[k]]; }

    double attitude_error(const std::vector<Sample>& samples) const {
        if (samples.size() < times_.size()) return unfit;
        return root_mean_square(times_.size(),
                                [&](std::size_t k) { return rotation_angle_between(samples[k].q, row(k).q); });
    }
    double attitude_error(const Scene& scene, const Alteration& alteration) const {
        return attitude_error((*motion_)(scene, alteration, times_));
    }

    // rows from the first on, twice as many each time, until the error is plain to see: beyond that it saturates, and a
    // broken engine's own rounding and steps hide what broke it. Not before the body has turned by two radians.
    bool choose_rows() {
        const std::size_t all = file_->rows.size();
        if (all < 3) return false;
        for (std::size_t count = std::min<std::size_t>(16, all);; count = std::min(2 * count, all)) {
            constexpr std::size_t most = 300;
            index_.clear(), times_.clear();
            for (std::size_t i = 0; i < std::min(count, most); ++i) {
                index_.push_back(count <= most ? i : i * (count - 1) / (most - 1));
                times_.push_back(row(i).t);
            }
            own_ = (*motion_)(*scene_, {}, times_);
            const bool complete = own_.size() == times_.size();
            if (!complete) index_.resize(own_.size()), times_.resize(own_.size());
            if (own_.size() < 3) return false;
            turned_ = length(own_[0].angular_velocity_B) * times_[0];
            for (std::size_t k = 1; k < own_.size(); ++k)
                turned_ += (times_[k] - times_[k - 1]) *
                           std::max(length(own_[k].angular_velocity_B), length(own_[k - 1].angular_velocity_B));
            attitude_error_ = attitude_error(own_);
            if (count == all || !complete || (attitude_error_ > 0.3 && turned_ > 2)) return true;
        }
    }

    /// Of the file's w against what a hypothesis predicts for row k, relative to the largest predicted.
    template <class Rate>
    std::optional<double> rates_left(const Rate& rate_W) const {
        if (!file_->has_angular_velocity) return {};
        double scale = 0;
        const double error = root_mean_square(times_.size(), [&](std::size_t k) {
            const Vector3<double> w = rate_W(k);
            scale = std::max(scale, length(w));
            return length(row(k).angular_velocity_W - w);
        });
        if (scale == 0) return {};
        return error / scale;
    }
    std::optional<double> rates_left(const Scene& scene, const Alteration& alteration) const {
        const std::vector<Sample> samples = (*motion_)(scene, alteration, times_);
        if (samples.size() < times_.size()) return {};
        return rates_left([&](std::size_t k) { return world_rate(samples[k]); });
    }

    std::string reach() const { return fmt::format("root mean square up to t = {:.4g} s", times_.back()); }

    void add(About about, const char* fault, double error, double explained, const std::string& what,
             const std::string& remedy, const Evidence& evidence = {}) {
        const char* unit = about == About::attitude ? " rad" : about == About::position ? " m" : " of the largest rate";
        found_.push_back({about,
                          {fault,
                           fmt::format("{}: {:.2g}{} is left of {:.2g}{} ({}); {}", what, explained, unit, error, unit,
                                       reach(), remedy),
                           evidence.convention, error, explained},
                          evidence.fitted,
                          evidence.rates_left ? evidence.rates_left() : std::nullopt});
    }
    // by the attitude; true where it explains the file
    bool consider(const char* fault, double explained, const std::string& what, const std::string& remedy,
                  const Evidence& evidence = {}, double needed = factor) {
        if (!(needed * explained <= attitude_error_)) return false;
        add(About::attitude, fault, attitude_error_, explained, what, remedy, evidence);
        return true;
    }

    // w in other units or axes, beside the scene's motion
    void find_in_rates() {
        if (!file_->has_angular_velocity) return;
        double scale = 0;
        for (const Sample& s : own_) scale = std::max(scale, length(s.angular_velocity_B));
        if (scale == 0) return;
        const auto error = [&](double unit, bool in_body) {
            return root_mean_square(own_.size(),
                                    [&](std::size_t k) {
                                        const Vector3<double> w = unit * row(k).angular_velocity_W;
                                        return length(w - (in_body ? own_[k].angular_velocity_B : world_rate(own_[k])));
                                    }) /
                   scale;
        };
        const double as_written = error(1, false);
        if (as_written < plain_error) return;
        const auto try_one = [&](const char* fault, double unit, bool in_body, const char* what, const char* remedy,
                                 const char* convention) {
            const double explained = error(unit, in_body);
            // a rate many times too large is made small by any smaller unit
            if (factor * explained <= as_written && explained < 1 / factor)
                add(About::rate, fault, as_written, explained, what, remedy, {convention});
        };
        try_one("angular_velocity_in_body_axes", 1, true, "wx,wy,wz are in body axes", "write them in world axes", "");
        try_one("angular_velocity_in_degrees", degree, false, "wx,wy,wz are in degrees per second",
                "write radians per second, or give --convention degrees", "degrees");
        try_one("angular_velocity_in_degrees_and_body_axes", degree, true,
                "wx,wy,wz are in degrees per second and in body axes", "write radians per second, in world axes", "");
    }

    void find_in_positions() {
        const Vector3<double>& center = scene_->body.center_of_mass;
        if (!(file_->has_position || file_->has_origin) || length(center) == 0) return;
        // sense: the factor of R center that is added to the column to reach the centre of mass
        const auto error = [&](double sense) {
            return root_mean_square(own_.size(), [&](std::size_t k) {
                const Quaternion<double>& q = own_[k].q;
                const Vector3<double> arm = (sense / squared_norm(q)) * rotate(q, center);
                return length(row(k).position_W + arm - own_[k].position_W);
            });
        };
        const double as_written = error(file_->has_origin ? 1 : 0), other = error(file_->has_origin ? 0 : 1);
        if (as_written < plain_error * length(center) || !(factor * other <= as_written)) return;
        if (file_->has_position)
            add(About::position, "origin_for_center_of_mass", as_written, other,
                "px,py,pz are the body's origin, not its centre of mass", "name the columns ox,oy,oz");
        else
            add(About::position, "center_of_mass_for_origin", as_written, other,
                "ox,oy,oz are the centre of mass, not the body's origin", "name the columns px,py,pz");
    }

    // the file's quaternions read in other ways: of equals the one that changes least
    void find_conventions() {
        struct Reading {
            Axes axes;
            bool scalar_last, inverse;
        };
        const auto read = [](const Reading& reading, const Quaternion<double>& q) {
            Quaternion<double> r = reading.scalar_last ? Quaternion<double>{q.z, q.w, q.x, q.y} : q;
            if (reading.inverse) r = conjugate(r);
            return quaternion_from(reading.axes, r);
        };
        std::optional<Reading> best;
        double least_error = attitude_error_ / factor;
        for (const bool inverse : {false, true})
            for (const Axes axes : {Axes::z_up_right, Axes::y_up_right, Axes::y_up_left, Axes::z_up_left})
                for (const bool scalar_last : {false, true}) {
                    const Reading reading{axes, scalar_last, inverse};
                    const double error = root_mean_square(own_.size(), [&](std::size_t k) {
                        return rotation_angle_between(own_[k].q, read(reading, row(k).q));
                    });
                    const bool changes = inverse || scalar_last || axes != Axes::z_up_right;
                    if (changes && error < (best ? least_error / 2 : least_error)) best = reading, least_error = error;
                }
        if (!best) return;
        Convention convention;
        convention.axes = best->axes;
        if (best->scalar_last) convention.quaternion = QuaternionColumns::scalar_last;
        std::string what;
        const auto say = [&](const std::string& part) { what += (what.empty() ? "" : " and ") + part; };
        if (best->axes != Axes::z_up_right) {
            Convention axes;
            axes.axes = best->axes;
            say("the attitude is written " + name_of(axes));
        }
        if (best->scalar_last) say("the quaternion is scalar-last: the columns qw,qx,qy,qz hold x, y, z, w");
        if (best->inverse) say("the attitude is inverted (transposed): it maps world to body");
        const char* fault = best->axes != Axes::z_up_right ? "other_axes"
                            : best->scalar_last            ? "scalar_last_quaternion"
                                                           : "inverted_orientation";
        const std::string named = best->inverse ? "" : name_of(convention);
        consider(fault, least_error, what,
                 best->inverse ? "write the conjugate quaternion" +
                                     (name_of(convention).empty() ? std::string()
                                                                  : ", and give --convention " + name_of(convention))
                               : "give --convention " + named,
                 {named});
    }

    void find_first_order_update() {
        if (!file_->has_angular_velocity) return;
        const std::optional<FirstOrderUpdate> update = first_order_update(*file_, index_.back() + 1);
        if (!update) return;
        const char* fault = "first_order_quaternion_update";
        found_.push_back(
            {About::attitude,
             {fault,
              fmt::format(
                  "first-order quaternion update: the attitude goes on by q + (h/2) w q with h = {:.4g} s, a turn "
                  "of 2 atan(|w| h/2) and not |w| h: {:.2g} rad is left of {:.2g} rad a row that the file's own w "
                  "leaves; turn by the exponential of w h, or take smaller steps",
                  update->step, update->explained, update->error),
              "", update->error, update->explained},
             false,
             {}});
    }

    // the rate in world axes stays, as it does without the gyroscopic term
    std::string steadiness() const {
        if (!file_->has_angular_velocity) return "";
        double change = 0, scale = 0;
        for (std::size_t k = 0; k < times_.size(); ++k) {
            change = std::max(change, length(row(k).angular_velocity_W - row(0).angular_velocity_W));
            scale = std::max(scale, length(row(k).angular_velocity_W));
        }
        if (!(change < 1e-3 * scale)) return "";
        return fmt::format(" (w in world axes stays constant within {:.1g} of itself)", change / scale);
    }

    void find_alterations() {
        const auto error = [&](double gyroscopic, double damping, double limit) {
            Alteration a;
            a.gyroscopic = gyroscopic, a.damping = damping, a.speed_limit = limit;
            return attitude_error(*scene_, a);
        };
        constexpr double none = std::numeric_limits<double>::infinity();
        const double missing = error(0, 0, none);
        const std::string turn_on = "turn the engine's gyroscopic term on";
        consider("gyroscopic_term_missing", missing, "the gyroscopic term is missing" + steadiness(), turn_on,
                 {"", false, [&] { return rates_left(*scene_, {.gyroscopic = 0}); }});
        consider("gyroscopic_term_reversed", error(-1, 0, none), "the gyroscopic term has the wrong sign",
                 "let I dw/dt = tau - w x I w", {"", false, [&] { return rates_left(*scene_, {.gyroscopic = -1}); }});
        find_speed_limit(error, missing);
        find_damping(error, missing);
    }

    // whether a second fault, too, is needed to explain what one leaves
    bool is_needed(double both, double one) const { return one > same * attitude_error_ && 3 * both < one; }

    // the largest rate of the file: by its columns, or by how far the attitude turns between rows. Not the first rows:
    // a start beyond the limit may stand there
    double largest_rate() const {
        double largest = 0;
        for (std::size_t k = 2; k < times_.size(); ++k)
            largest = std::max(largest, file_->has_angular_velocity ? length(row(k).angular_velocity_W)
                                                                    : rotation_angle_between(row(k).q, row(k - 1).q) /
                                                                          (times_[k] - times_[k - 1]));
        return largest;
    }

    template <class Error>
    void find_speed_limit(const Error& error, double missing) {
        const double largest = largest_rate();
        double own = 0;
        for (const Sample& s : own_) own = std::max(own, length(s.angular_velocity_B));
        // the scene wants to turn faster than the file ever does
        if (!(largest > 0 && largest < 0.99 * own)) return;
        for (const double gyroscopic : {1.0, 0.0}) {
            const auto [limit, explained] =
                least([&](double x) { return error(gyroscopic, 0, x); },
                      {0.98 * largest, 0.99 * largest, largest, 1.01 * largest, 1.02 * largest});
            if (gyroscopic == 0 && !is_needed(explained, missing)) return;
            if (consider("speed_clamped", explained,
                         fmt::format("the speed is clamped at {:.4g} rad/s, where the scene reaches {:.4g}{}", limit,
                                     own, gyroscopic == 0 ? ", and the gyroscopic term is missing" : ""),
                         gyroscopic == 0 ? "raise the engine's limit on angular speed and turn its gyroscopic term on"
                                         : "raise the engine's limit on angular speed",
                         {"", true, [&, limit = limit] {
                              return rates_left(*scene_, {.gyroscopic = gyroscopic, .speed_limit = limit});
                          }}))
                return;
        }
    }

    template <class Error>
    void find_damping(const Error& error, double missing) {
        constexpr double none = std::numeric_limits<double>::infinity();
        std::vector<double> grid;
        for (int i = 0; i <= 16; ++i) grid.push_back(std::log(std::pow(10.0, -3 + 0.25 * i) / times_.back()));
        for (const double gyroscopic : {1.0, 0.0}) {
            const auto [log_rate, explained] =
                least([&](double x) { return error(gyroscopic, std::exp(x), none); }, grid);
            // the other fault alone does as well
            if (gyroscopic == 0 && !is_needed(explained, missing)) return;
            const double rate = std::exp(log_rate);
            const std::string what =
                fmt::format("damping is left on: w dies away at {:.3g} 1/s more than in the scene{}", rate,
                            gyroscopic == 0 ? ", and the gyroscopic term is missing" : "");
            if (consider("damping_left_on", explained, what,
                         gyroscopic == 0 ? "turn the engine's angular damping off and its gyroscopic term on"
                                         : "turn the engine's angular damping off",
                         {"", true, [&] { return rates_left(*scene_, {.gyroscopic = gyroscopic, .damping = rate}); }},
                         fitted_factor))
                return;
        }
    }

    // the scene's own motion at s times the file's times
    void find_wrong_time() {
        // a grid fine enough for cubic interpolation: h w = 0.05 leaves (h w)^4 / 384 = 2e-8 rad
        constexpr double most_s = 4;
        // rows a radian and more apart fit many a time
        if (turned_ > static_cast<double>(times_.size())) return;
        const double end = times_.back() * most_s;
        double rate = 0;
        for (const Sample& s : own_) rate = std::max(rate, length(s.angular_velocity_B));
        const double count = std::ceil(2 * end * rate / 0.05);
        if (!(count >= 1 && count <= 40000)) return;
        std::vector<double> grid_times;
        for (int i = 0; i <= static_cast<int>(count); ++i) grid_times.push_back(end * i / count);
        const std::vector<Sample> dense = (*motion_)(*scene_, {}, grid_times);
        if (dense.size() < grid_times.size()) return;
        const auto error = [&](double s) {
            return root_mean_square(times_.size(), [&](std::size_t k) {
                return rotation_angle_between(interpolated_attitude(dense, end / count, s * times_[k]), row(k).q);
            });
        };
        std::vector<double> grid;
        for (double s = 0.25; s <= most_s; s *= 1.03) grid.push_back(s);
        for (int i = -10; i <= 10; ++i) grid.push_back(1 + 0.1 * i / std::max(turned_, 1.0));
        std::sort(grid.begin(), grid.end());
        const std::pair<double, double> best = least([&](double x) { return error(std::clamp(x, 0.0, most_s)); }, grid);
        const double s = best.first, explained = best.second;
        // methods of low order run fast or slow by a little as well; a small turn fits many a time
        if (std::abs(s - 1) < 0.02 || turned_ < 1) return;
        // the scene's w at those times, from the nearest of the grid
        const auto rate_at = [&](std::size_t k) {
            const double place = std::round(s * times_[k] * count / end);
            return world_rate(dense[static_cast<std::size_t>(std::clamp(place, 0.0, count))]);
        };
        consider("wrong_time_step", explained,
                 fmt::format("the time is wrong: the body moves as the scene does, {:.5g} times as fast", s),
                 fmt::format("multiply the step by {:.5g}, or the times by {:.5g}", 1 / s, s),
                 {"", true, [&] { return rates_left(rate_at); }}, fitted_factor);
    }

    // scenes that an engine was given in place of this one
    void find_other_scenes() {
        const auto try_one = [&](const char* fault, const Scene& scene, const std::string& what, const char* remedy) {
            consider(fault, attitude_error(scene, {}), what, remedy,
                     {"", false, [&] { return rates_left(scene, Alteration{}); }});
        };
        Scene other = *scene_;
        if (length(scene_->body.center_of_mass) > 0) {
            other.body.source = nullptr;
            other.body.center_of_mass = {};
            try_one("center_of_mass_for_origin", other,
                    "the centre of mass is taken for the body's origin: arms and pivot are counted from there",
                    "give the engine the body's centre of mass");
            if (scene_->pivot && length(*scene_->pivot) == 0) {
                other.body.inertia_B =
                    other.body.inertia_B + parallel_axis(other.body.mass, scene_->body.center_of_mass);
                try_one(
                    "center_of_mass_for_origin", other,
                    "forces act as if the centre of mass were the body's origin: the inertia alone knows where it is",
                    "give the engine the body's centre of mass");
            }
            other = *scene_;
        }
        for (const double unit : {degree, 1 / degree}) {
            other.initial.angular_velocity = unit * scene_->initial.angular_velocity;
            try_one("degrees_for_radians", other,
                    unit < 1 ? "the initial angular velocity is taken for degrees per second"
                             : "the initial angular velocity in rad/s is converted from degrees once too often",
                    "start the engine in its own unit");
            other = *scene_;
        }
        const bool in_body = scene_->initial.angular_velocity_frame == Frame::body;
        other.initial.angular_velocity_frame = in_body ? Frame::world : Frame::body;
        try_one("body_for_world_angular_velocity", other,
                fmt::format("the initial angular velocity is taken in {} axes", in_body ? "world" : "body"),
                "turn it into the engine's axes first");
        other = *scene_;
        const Quaternion<double>& q = scene_->initial.orientation;
        other.initial.orientation = conjugate(q);
        try_one("inverted_initial_orientation", other, "the initial orientation is inverted (transposed)",
                "start from the conjugate");
        other.initial.orientation = {q.z, q.w, q.x, q.y};
        try_one("scalar_last_initial_orientation", other,
                "the initial orientation is read scalar-last: w, x, y, z taken for x, y, z, w",
                "give the engine the components in its own order");
    }

    std::vector<Diagnosis> ranked() {
        const auto left = [](const Found& f) { return std::max(same, f.diagnosis.explained / f.diagnosis.error); };
        std::stable_sort(found_.begin(), found_.end(),
                         [&](const Found& a, const Found& b) { return left(a) < left(b); });
        std::vector<const Found*> told;
        for (const Found& f : found_) {
            const auto better = [&](const Found& g) {
                if (g.about != f.about) return false;
                if (dominated * left(g) < left(f)) return true;
                // as good by the attitude: the file's own w, or that nothing had to be fitted, speaks for one of them
                if (!(left(g) <= dominated * left(f))) return false;
                const bool contradicted = f.rates_left && g.rates_left && *f.rates_left > plain_rates &&
                                          *f.rates_left > rates_factor * *g.rates_left;
                const bool supported = !f.rates_left || !g.rates_left ||
                                       *g.rates_left <= rates_factor * *f.rates_left || *g.rates_left <= plain_rates;
                return contradicted || (f.fitted && !g.fitted && supported);
            };
            // of two ways to the same fault the nearer
            const auto is_told = [&](const Found* g) {
                return g->about == f.about && g->diagnosis.fault == f.diagnosis.fault;
            };
            if (std::none_of(found_.begin(), found_.end(), better) && std::none_of(told.begin(), told.end(), is_told))
                told.push_back(&f);
        }
        std::vector<Diagnosis> result;
        for (const Found* f : told) result.push_back(f->diagnosis);
        return result;
    }
};

}  // namespace

std::vector<Diagnosis> diagnose(const Scene& scene, const TrajectoryFile& file, const AlteredMotion& motion) {
    return Examination(scene, file, motion).diagnoses();
}

}  // namespace polhode
