#include "check/evidence.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "body/elementary.h"
#include "body/mass_properties.h"
#include "body/orientation.h"
#include "motion/contact.h"

namespace polhode {
namespace {

using Vector = Vector3<double>;

// largest number of steps, of steps with events, and of rows of a run
constexpr std::size_t max_windows = 32, most_event_windows = 6, most_rows_of_a_run = 48;
// smallest relative prediction error: the error of accurate steps
constexpr double finest = 1e-9;

// Returns |a - b| relative to the larger change, at most 2.
double relative(double difference, double total_change, double other_change) {
    const double scale = std::max(total_change, other_change);
    return difference == 0 ? 0 : scale > 0 && std::isfinite(difference) ? std::min(difference / scale, 2.0) : 2.0;
}

// An answer and its value for a perfect prediction, decades.
struct PredictionError {
    double value = 0, least = 0;
};
PredictionError answer(double error, double noise) {
    const double floor = std::max(finest, 3 * noise);
    const double least = std::log10(std::min(floor, 2.0));
    return {error > floor ? std::log10(error) : least, least};
}

// Mean of answers.
struct Mean {
    PredictionError sum;
    int count = 0;

    void add(const PredictionError& a) { sum.value += a.value, sum.least += a.least, ++count; }
    void store(Residual& r, Criterion criterion) const {
        if (count == 0) return;
        r[criterion] = sum.value / count, r.least += sum.least / count;
        r.worst = std::max(r.worst, (sum.value - sum.least) / count);
    }
};

// Difference of two vectors relative to their length, or to their change from `base`.
double relative_difference(const Vector& a, const Vector& b) { return relative(length(a - b), length(a), length(b)); }
double relative_difference(const Vector& a, const Vector& b, const Vector& base) {
    return relative(length(a - b), length(a - base), length(b - base));
}

// Approximates the angle between two unit quaternions by their chord: fast, and equal for small angles.
double chord(const Quaternion<double>& a, const Quaternion<double>& b) {
    const double cosine = a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z, sense = cosine < 0 ? -1 : 1;
    const double w = a.w - sense * b.w, x = a.x - sense * b.x, y = a.y - sense * b.y, z = a.z - sense * b.z;
    return 2 * std::sqrt(w * w + x * x + y * y + z * z);
}

// Selects the rule by which the position follows the velocity in the file: new, mean or old velocity.
const Mean& nearest(const std::array<Mean, 3>& places) {
    return *std::min_element(places.begin(), places.end(),
                             [](const Mean& a, const Mean& b) { return a.sum.value < b.sum.value; });
}

// Whether x is a decimal number with this number of significant digits.
bool has_digits(double x, int digits) {
    char text[32];
    std::snprintf(text, sizeof text, "%.*g", digits, x);
    return std::strtod(text, nullptr) == x;
}

}  // namespace

FileEvidence::FileEvidence(const Scene& scene, const TrajectoryFile& file) : scene_(&scene), file_(&file) {
    sound_.scene = scene;
    const ExactBody<double> body = exact_body<double>(scene);
    // numeric mass properties are sufficient: the tested steps do not meet a plane
    sound_.scene.body.mass = body.mass, sound_.scene.body.center_of_mass = body.center;
    if (scene.body.source) {
        sound_.scene.body.source = nullptr, sound_.scene.body.inertia_B = body.inertia_B;
        if (body.pivoted) sound_.scene.body.inertia_B = body.inertia_B + parallel_axis(-body.mass, body.arm);
    }
    sound_.scene.planes.clear();
    sound_.reading.origin = file.has_origin;
    if (file.rows.size() < 3) return;
    last_ = file.rows.size() - 1;
    find_noise();
    facts_.duration = file.rows.back().t - file.rows.front().t;
    facts_.row = facts_.duration / static_cast<double>(last_);
    std::vector<double> rates;
    for (std::size_t k = 2; k <= last_; ++k)
        rates.push_back(file.has_angular_velocity ? length(file.rows[k].angular_velocity_W)
                                                  : rotation_angle_between(file.rows[k].q, file.rows[k - 1].q) /
                                                        (file.rows[k].t - file.rows[k - 1].t));
    std::sort(rates.begin(), rates.end());
    facts_.largest_rate = rates.back(), facts_.usual_rate = rates[rates.size() / 2];
    for (std::size_t k = 1; k <= last_; ++k) {
        const TrajectoryRow &row = file.rows[k], &before = file.rows[k - 1];
        const Quaternion<double> q = normalized(row.q);
        // without w, the mean rate from row to row
        const Vector w_B =
            file.has_angular_velocity
                ? rotate_back(q, row.angular_velocity_W)
                : (1 / (row.t - before.t)) * rotation_vector_from_quaternion(conjugate(normalized(before.q)) * q);
        const Vector w_W = rotate(q, w_B);
        for (int i = 0; i < 3; ++i) {
            facts_.largest_rates_W[i] = std::max(facts_.largest_rates_W[i], std::abs(w_W[i]));
            facts_.largest_rates_B[i] = std::max(facts_.largest_rates_B[i], std::abs(w_B[i]));
        }
    }
    compare_with_scene();
    choose_windows();
}

// Finds the precision of the file: binary64, binary32, or decimals of four to twelve digits.
void FileEvidence::find_noise() {
    bool float32 = true;
    int digits = 4;
    const std::size_t stride = std::max<std::size_t>(1, file_->rows.size() / 100);
    for (std::size_t k = 0; k < file_->rows.size(); k += stride) {
        const TrajectoryRow& row = file_->rows[k];
        // a constant column may hold a round number, so all columns are tested
        std::vector<double> all{row.q.w, row.q.x, row.q.y, row.q.z};
        for (const Vector* block : {&row.angular_velocity_W, &row.position_W, &row.velocity_W})
            all.insert(all.end(), block->component.begin(), block->component.end());
        for (const double x : all) {
            float32 = float32 && static_cast<double>(static_cast<float>(x)) == x;
            while (digits < 15 && !has_digits(x, digits)) ++digits;
        }
    }
    noise_ = digits < 13 ? std::pow(10.0, -digits) : 1e-15;
    // binary32 is printed with seven to nine digits
    if (float32 || (digits >= 7 && digits <= 9)) noise_ = std::max(noise_, 1.2e-7);
}

// Computes the scene's motion at some rows, as far as this is fast. Finds the error of the file, the first contact
// with a plane, and whether a body that rests in the file should move.
void FileEvidence::compare_with_scene() {
    const EngineModel model(sound_);
    const UpdateRule& accurate = update_rules().front();
    const std::shared_ptr<const ContactGeometry<double>> geometry = pose(*scene_, Formulation::full).body.geometry;
    const double rate = std::max(model.problem().scales.angular_velocity, 1e-3);
    const double longest_time = 2000 / rate;  // s: 40,000 small steps
    std::size_t rows = last_ + 1;
    while (rows > 3 && file_->rows[rows - 1].t > std::max(longest_time, file_->rows[2].t)) --rows;
    const std::size_t stride = geometry->any() ? 1 : std::max<std::size_t>(1, rows / 200);
    // the file does not change from row `still` on
    std::size_t still = last_;
    while (still > 0 && same(still - 1, last_)) --still;
    ModelState s = model.start();
    double t = 0, scale_w = 0, scale_p = 0, scale_v = 0, worst_w = 0, worst_p = 0, worst_v = 0, worst_q = 0;
    bool has_rest_check = false;
    for (std::size_t k = 0; k < rows && facts_.duration > 0; k += stride) {
        const double next = file_->rows[k].t;
        if (next > t) model.advance(s, t, next - t, accurate, 1);
        t = std::max(t, next);
        if (geometry->any() &&
            geometry->distance({s.q, s.position_W, s.velocity_W, rotate(s.q, s.angular_velocity_B)}) <=
                2 * length(s.velocity_W) * facts_.row) {
            last_ = k > 0 ? k - 1 : 0;
            break;
        }
        if (k >= still && !has_rest_check) {
            has_rest_check = true;
            const double left = file_->rows.back().t - t;
            if (last_ - still >= 3 && length(s.angular_velocity_B) * left > 0.05) rest_start_ = file_->rows[still].t;
        }
        const ModelState f = state(sound_, k);
        scale_w = std::max(scale_w, length(s.angular_velocity_B)), scale_p = std::max(scale_p, length(s.position_W));
        scale_v = std::max(scale_v, length(s.velocity_W));
        worst_q = std::max(worst_q, rotation_angle_between(s.q, f.q));
        if (file_->has_angular_velocity)
            worst_w = std::max(worst_w, length(s.angular_velocity_B - f.angular_velocity_B));
        if (file_->has_position || file_->has_origin) worst_p = std::max(worst_p, length(s.position_W - f.position_W));
        if (file_->has_velocity) worst_v = std::max(worst_v, length(s.velocity_W - f.velocity_W));
    }
    const auto over = [](double worst, double scale) { return worst == 0 ? 0.0 : scale > 0 ? worst / scale : 1.0; };
    plain_error_ = std::max({worst_q, over(worst_w, scale_w), over(worst_p, scale_p), over(worst_v, scale_v)});
    if (rest_start_) last_ = std::min(last_, still);
}

bool FileEvidence::same(std::size_t a, std::size_t b) const {
    const TrajectoryRow &x = file_->rows[a], &y = file_->rows[b];
    return x.q == y.q && x.angular_velocity_W == y.angular_velocity_W && x.position_W == y.position_W;
}

// Chooses the steps to test, more of them early: if an engine diverges, its first steps are more informative.
void FileEvidence::choose_windows() {
    if (last_ < 2) return;
    const EngineModel model(sound_);
    std::size_t events = 0;
    for (std::size_t k = 0; k < last_; ++k)
        if (events < most_event_windows && model.has_event(file_->rows[k].t, file_->rows[k + 1].t - file_->rows[k].t))
            windows_.push_back(k), ++events;
    const std::size_t count = std::min(max_windows, last_);
    for (std::size_t i = 0; i < count; ++i) {
        const double x = static_cast<double>(i) / static_cast<double>(count);
        const std::size_t spread = static_cast<std::size_t>(x * x * static_cast<double>(last_));
        windows_.push_back(std::min(std::max(i, spread), last_ - 1));
    }
    std::sort(windows_.begin(), windows_.end());
    windows_.erase(std::unique(windows_.begin(), windows_.end()), windows_.end());
}

ModelState FileEvidence::state(const Cause& cause, std::size_t k) const {
    const Reading& read = cause.reading;
    const TrajectoryRow& row = file_->rows[k];
    Quaternion<double> q = row.q;
    if (read.scalar_last) q = {q.z, q.w, q.x, q.y};
    if (read.inverted) q = conjugate(q);
    ModelState s;
    s.q = normalized(quaternion_from(read.axes, q));
    const Vector w = read.rate_unit * pseudovector_from(read.axes, row.angular_velocity_W);
    s.angular_velocity_B = read.rate_in_body ? w : rotate_back(s.q, w);
    s.position_W = (read.length_unit * read.position_unit) * vector_from(read.axes, row.position_W);
    s.velocity_W = (read.length_unit * read.velocity_unit) * vector_from(read.axes, row.velocity_W);
    if (read.origin) s.position_W = s.position_W + rotate(s.q, sound_.scene.body.center_of_mass);
    if (file_->has_angular_velocity) convert_origin_velocity(cause, s.angular_velocity_B, s);
    return s;
}

// Rounding error of a position, m. If the file has the origin, the centre of mass is a sum in which digits may cancel.
double FileEvidence::position_noise(const Cause& cause, const ModelState& s) const {
    const double from_origin = cause.reading.origin ? length(sound_.scene.body.center_of_mass) : 0;
    return noise_ * (length(s.position_W) + from_origin);
}

// Converts the velocity of the body's origin to that of its centre of mass, if the cause reads the former.
void FileEvidence::convert_origin_velocity(const Cause& cause, const Vector& w_B, ModelState& s) const {
    if (cause.reading.velocity_of_origin && file_->has_velocity)
        s.velocity_W = s.velocity_W + rotate(s.q, cross(w_B, sound_.scene.body.center_of_mass));
}

void FileEvidence::compare_start(const Cause& cause, const EngineModel& model, const UpdateRule& rule, int steps,
                                 Residual& r) const {
    const int late = cause.reading.rows_late;
    const std::size_t row = static_cast<std::size_t>(std::max(late, 0));
    ModelState start = model.start();
    // the scene's state at the time of the first row, or one row later
    double t = 0, until = file_->rows.front().t;
    if (late < 0) until += file_->rows[1].t - file_->rows[0].t;
    if (until > t) {
        const int count = std::max(1, static_cast<int>(std::lround(std::min((until - t) / facts_.row, 1e4))));
        model.advance(start, t, until - t, rule, count * steps);
    }
    ModelState f = state(cause, row);
    if (!file_->has_angular_velocity) convert_origin_velocity(cause, start.angular_velocity_B, f);
    const auto store_error = [&](Criterion criterion, double error) {
        Mean one;
        one.add(answer(error, noise_));
        one.store(r, criterion);
    };
    store_error(Criterion::start_attitude, std::min(chord(start.q, f.q), 2.0));
    const auto compare = [&](Criterion criterion, const Vector& a, const Vector& b) {
        if (!(length(a) == 0 && length(b) == 0)) store_error(criterion, relative_difference(a, b));
    };
    if (file_->has_angular_velocity) {
        // a limit may act at the start or from the first step on
        ModelState limited = start;
        model.limit(limited, 0);
        const Vector &w = f.angular_velocity_B, &given = start.angular_velocity_B, &cut = limited.angular_velocity_B;
        compare(Criterion::start_rate, relative_difference(cut, w) < relative_difference(given, w) ? cut : given, w);
    }
    const double blur = 3 * position_noise(cause, f);
    if ((file_->has_position || file_->has_origin) && (length(start.position_W) > blur || length(f.position_W) > blur))
        compare(Criterion::start_position, start.position_W, f.position_W);
    if (file_->has_velocity) compare(Criterion::start_velocity, start.velocity_W, f.velocity_W);
}

void FileEvidence::compare_steps(const Cause& cause, const EngineModel& model, const UpdateRule& rule, int steps,
                                 Residual& r, std::vector<double>* by_step) const {
    const bool position = file_->has_position || file_->has_origin;
    const std::size_t late = static_cast<std::size_t>(std::max(cause.reading.rows_late, 0));
    Mean attitude, rate, velocity, first, events;
    std::array<Mean, 3> places;
    for (const std::size_t k : windows_) {
        if (k < late) continue;
        // time of a row in the engine, which may be a row late or early
        const auto time = [&](std::size_t row) {
            const double shift = static_cast<double>(cause.reading.rows_late) * facts_.row;
            return std::max(0.0, file_->rows[row].t - shift);
        };
        const bool event = model.has_event(file_->rows[k].t, file_->rows[k + 1].t - file_->rows[k].t);
        // an engine may process an event one step early or late
        const std::size_t from = event ? std::max(k, late + 1) - 1 : k, to = event ? std::min(k + 2, last_) : k + 1;
        ModelState base = state(cause, from);
        if (!file_->has_velocity && position && !model.body().pivoted) {
            if (from == 0) continue;
            const ModelState before = state(cause, from - 1);
            base.velocity_W = (1 / (time(from) - time(from - 1))) * (base.position_W - before.position_W);
        }
        ModelState next = base;
        Vector position_difference;
        for (std::size_t row = from; row < to; ++row)
            position_difference =
                position_difference + model.advance(next, time(row), time(row + 1) - time(row), rule, steps);
        if (!file_->has_velocity && position && !model.body().pivoted)
            next.position_W = base.position_W + (time(to) - time(from)) * next.velocity_W, position_difference = {};
        const ModelState f = state(cause, to);
        const double turned =
                         std::max(chord(f.q, base.q), 0.1 * std::min(1.0, length(f.angular_velocity_B) * facts_.row)),
                     total_change = length(f.position_W - base.position_W);
        const PredictionError q = answer(relative(chord(next.q, f.q), chord(next.q, base.q), chord(f.q, base.q)),
                                         noise_ / std::max(turned, 1e-12)),
                              w = answer(relative_difference(next.angular_velocity_B, f.angular_velocity_B), noise_),
                              v = answer(relative_difference(next.velocity_W, f.velocity_W), noise_);
        if (event) {
            events.add({(q.value + w.value) / 2, (q.least + w.least) / 2});
            if (file_->has_velocity) events.add(v);
            continue;
        }
        if (k == late) first.add({(q.value + w.value) / 2, (q.least + w.least) / 2});
        attitude.add(q), rate.add(w);
        if (by_step != nullptr) by_step->push_back((q.value + w.value) / 2);
        if (file_->has_velocity) velocity.add(v);
        if (!position) continue;
        for (int i = 0; i < 3; ++i)
            places[static_cast<std::size_t>(i)].add(answer(
                relative_difference(next.position_W - (0.5 * i) * position_difference, f.position_W, base.position_W),
                position_noise(cause, f) / std::max(total_change, 1e-300)));
    }
    attitude.store(r, Criterion::attitude), rate.store(r, Criterion::rate), velocity.store(r, Criterion::velocity);
    // a first step that happens to be better than the others gives no advantage
    if (first.count > 0 && attitude.count > 0) {
        const double others = (attitude.sum.value + rate.sum.value) / (2 * attitude.count);
        first.sum.value = std::max(first.sum.value, others * first.count);
    }
    first.store(r, Criterion::first_step), events.store(r, Criterion::events);
    nearest(places).store(r, Criterion::position);
}

// For files without w: runs the engine from its start, row by row.
void FileEvidence::compare_run(const Cause& cause, const EngineModel& model, const UpdateRule& rule, int steps,
                               Residual& r) const {
    const bool position = file_->has_position || file_->has_origin;
    const std::size_t late = static_cast<std::size_t>(std::max(cause.reading.rows_late, 0));
    ModelState s = model.start();
    if (cause.reading.rows_late < 0) model.advance(s, 0, file_->rows[1].t - file_->rows[0].t, rule, steps);
    const ModelState start = s;
    Mean attitude, velocity, events;
    std::array<Mean, 3> places;
    Vector position_difference;
    // up to a dozen rows after the last event, if this is not too far
    std::size_t end = std::min(last_, late + most_rows_of_a_run);
    std::size_t first_event = last_;
    for (const std::size_t k : windows_)
        if (model.has_event(file_->rows[k].t, file_->rows[k + 1].t - file_->rows[k].t) && k < 10 * most_rows_of_a_run)
            first_event = std::min(first_event, k + 1), end = std::max(end, std::min(last_, k + 12));
    double t = 0, turned = 0, traveled = 0, change = 0;
    for (std::size_t k = late; k <= end; ++k) {
        const double next = file_->rows[k - late].t;
        const ModelState before = s;
        if (next > t) position_difference = position_difference + model.advance(s, t, next - t, rule, steps);
        t = std::max(t, next);
        ModelState f = state(cause, k);
        convert_origin_velocity(cause, s.angular_velocity_B, f);
        turned += chord(before.q, s.q), traveled += length(s.position_W - before.position_W);
        change = std::max({change, length(s.velocity_W), length(f.velocity_W)});
        if (k == late) continue;
        const PredictionError q =
            answer(relative(chord(s.q, f.q), turned, chord(f.q, start.q)), noise_ / std::max(turned, 1e-12));
        (k > first_event ? events : attitude).add(q);
        for (int i = 0; position && i < 3; ++i)
            places[static_cast<std::size_t>(i)].add(
                answer(relative(length(s.position_W - (0.5 * i) * position_difference - f.position_W), traveled,
                                length(f.position_W - start.position_W)),
                       position_noise(cause, f) / std::max(traveled, 1e-300)));
        if (file_->has_velocity) velocity.add(answer(relative(length(s.velocity_W - f.velocity_W), change, 0), noise_));
        if (turned > 20 && (k > first_event || first_event == last_)) break;
    }
    attitude.store(r, Criterion::attitude), velocity.store(r, Criterion::velocity), events.store(r, Criterion::events);
    nearest(places).store(r, Criterion::position);
}

std::vector<double> FileEvidence::by_step(const Cause& cause, const EngineModel& model, const UpdateRule& rule,
                                          int steps) const {
    std::vector<double> decades;
    Residual r;
    if (file_->has_angular_velocity) compare_steps(cause, model, rule, steps, r, &decades);
    return decades;
}

Residual FileEvidence::residual(const Cause& cause, const EngineModel& model, const UpdateRule& rule, int steps) const {
    Residual r;
    compare_start(cause, model, rule, steps, r);
    if (file_->has_angular_velocity)
        compare_steps(cause, model, rule, steps, r);
    else
        compare_run(cause, model, rule, steps, r);
    for (const std::optional<double>& value : r.decades) r.total += value.value_or(0);
    return r;
}

}  // namespace polhode
