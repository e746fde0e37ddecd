#include "report/motion_contacts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "integrators/analysis/contact_history.h"
#include "integrators/contact/solve_contacts.h"
#include "motion/problem.h"
#include "report/timeline.h"
#include "scene/plane_file.h"
#include "scene/sphere_contacts.h"
#include "text/message.h"

namespace polhode {
namespace {

constexpr std::size_t contact_samples = 800;
// tolerance of linear interpolation between samples, relative to the largest value
constexpr double curve_tolerance = 3e-3;
// forces below this ratio to the normal force are rounding
constexpr double force_rounding = 1e-12;
constexpr int force_digits = 4;

// One contact of a body with a plane: samples of all its intervals.
struct PlaneContact {
    std::size_t body = 0, plane = 0;
    std::vector<std::size_t> starts;  // index of each interval's first sample
    std::vector<ContactSample> samples;
};

// Tolerance of the interpolation between the samples of a contact.
struct ContactTolerance {
    double point = 0, force = 0, slip = 0;  // m, N, m/s
};

ContactSample interpolated(const ContactSample& a, const ContactSample& b, double t) {
    const double s = b.t > a.t ? (t - a.t) / (b.t - a.t) : 0;
    const auto between = [s](const Vector3<double>& u, const Vector3<double>& v) { return u + s * (v - u); };
    return {t, between(a.point_W, b.point_W), between(a.force_W, b.force_W), between(a.slip_W, b.slip_W)};
}

// Few of the samples, between which interpolation reproduces the others.
std::vector<ContactSample> thin_samples(const std::vector<ContactSample>& all, const ContactTolerance& tolerance) {
    const auto is_good = [&](std::size_t from, std::size_t to) {
        for (std::size_t k = from + 1; k < to; ++k) {
            const ContactSample near = interpolated(all[from], all[to], all[k].t);
            if (length(near.point_W - all[k].point_W) > tolerance.point ||
                length(near.force_W - all[k].force_W) > tolerance.force ||
                length(near.slip_W - all[k].slip_W) > tolerance.slip)
                return false;
        }
        return true;
    };
    std::vector<ContactSample> few;
    for (std::size_t from = 0; from < all.size();) {
        few.push_back(all[from]);
        std::size_t to = from + 1;
        while (to + 1 < all.size() && is_good(from, to + 1)) ++to;
        from = to;
    }
    return few;
}

Json contact_json(const Scene& scene, const PlaneContact& contact, std::size_t row) {
    const Plane& plane = scene.planes[contact.plane];
    const Vector3<double> n = (1 / length(plane.normal_W)) * plane.normal_W;
    Json t = Json::array(), point = Json::array(), normal = Json::array(), friction = Json::array(),
         slip = Json::array();
    const auto push = [](Json& list, const Vector3<double>& v, int digits) {
        for (int i = 0; i < 3; ++i) list.push_back(number_json(v[i], digits));
    };
    for (const ContactSample& sample : contact.samples) {
        const double N = dot(sample.force_W, n);
        const Vector3<double> F = sample.force_W - N * n;
        t.push_back(number_json(sample.t, 7));
        push(point, sample.point_W, 6);
        normal.push_back(number_json(N, force_digits));
        push(friction, length(F) > force_rounding * std::abs(N) ? F : Vector3<double>(), force_digits);
        push(slip, sample.slip_W, force_digits);
    }
    return {{"row", row},
            {"body", contact.body},
            {"plane", contact.plane},
            {"friction", number_json(plane.friction, 6)},
            {"starts", contact.starts},
            {"t", std::move(t)},
            {"point", std::move(point)},
            {"normal_force", std::move(normal)},
            {"friction_force", std::move(friction)},
            {"slip", std::move(slip)}};
}

// Fills the rows of the timeline and collects the samples of each contact.
class ContactTimeline {
  public:
    // `reach`: tolerance of contact points, m
    ContactTimeline(const Scene& scene, const ContactHistory& history, double reach)
        : scene_(scene), history_(history), tolerance_{reach, 0, 0} {
        for (const std::vector<ContactSample>& samples : history.of_interval)
            for (const ContactSample& sample : samples) {
                tolerance_.force = std::max(tolerance_.force, curve_tolerance * length(sample.force_W));
                tolerance_.slip = std::max(tolerance_.slip, curve_tolerance * length(sample.slip_W));
            }
        // planes of a single body have a row even if nothing happens there
        if (body_count(scene) == 1)
            for (std::size_t i = 0; i < scene.planes.size(); ++i) row_of(i);
        add_events();
        add_intervals();
    }

    MotionDetails details() const {
        MotionDetails details;
        details.timeline = timeline_.json();
        for (const auto& [row, contact] : contacts_)
            if (!contact.samples.empty()) details.contacts.push_back(contact_json(scene_, contact, row));
        return details;
    }

  private:
    std::optional<std::size_t> row_of(std::size_t contact) {
        const ContactNames names = contact_names(scene_, contact);
        const std::string other = one_line(names.other, 60);
        const std::optional<std::size_t> row =
            timeline_.row(body_count(scene_) > 1 ? one_line(names.body, 60) + ", " + other : other, "N s");
        if (row && parts_of_contact(scene_, contact).plane) plane_rows_.insert(*row);
        return row;
    }

    void add_events() {
        for (const contact::Event<double>& event : history_.record.events)
            timeline_.add_event(event.t, row_of(event.plane),
                                contact::event_names[static_cast<std::size_t>(event.kind)], event.normal_impulse,
                                length(event.tangential_impulse_W));
    }

    void add_intervals() {
        std::map<std::size_t, double> covered;  // by row: end of its last mode
        double end = 0;
        for (std::size_t i = 0; i < history_.record.intervals.size(); ++i) {
            const contact::Interval<double>& interval = history_.record.intervals[i];
            end = std::max(end, interval.to);
            if (interval.mode == contact::Mode::flight || !(interval.to > interval.from)) continue;
            const std::optional<std::size_t> row = row_of(interval.plane);
            if (!row) continue;
            double& until = covered[*row];
            if (interval.from > until) timeline_.add_mode(*row, until, interval.from, "flight");
            timeline_.add_mode(*row, interval.from, interval.to,
                               contact::mode_names[static_cast<std::size_t>(interval.mode)]);
            until = interval.to;
            add_samples(*row, interval.plane, history_.of_interval[i]);
        }
        for (const std::size_t row : plane_rows_)
            if (const double until = covered[row]; until < end) timeline_.add_mode(row, until, end, "flight");
    }

    void add_samples(std::size_t row, std::size_t number, const std::vector<ContactSample>& samples) {
        const ContactParts parts = parts_of_contact(scene_, number);
        if (!parts.plane) return;
        PlaneContact& contact = contacts_[row];
        contact.body = parts.body, contact.plane = *parts.plane;
        if (samples.empty()) return;
        contact.starts.push_back(contact.samples.size());
        const std::vector<ContactSample> few = thin_samples(samples, tolerance_);
        contact.samples.insert(contact.samples.end(), few.begin(), few.end());
    }

    const Scene& scene_;
    const ContactHistory& history_;
    ContactTolerance tolerance_;
    Timeline timeline_;
    std::map<std::size_t, PlaneContact> contacts_;  // by row
    std::set<std::size_t> plane_rows_;
};

}  // namespace

MotionDetails contacts_of_motion(const Scene& scene, const Reference& truth, const Tolerance& tolerance) {
    MotionDetails details;
    const ContactHistory history = contact_history(pose(scene), times_of_reference(truth), contact_samples);
    if (!is_near_truth(history.motions, truth, tolerance)) {
        details.remark =
            "Contacts are not shown: they are computed in binary64, and this motion is too sensitive for that.";
        return details;
    }
    details = ContactTimeline(scene, history, tolerance.length).details();
    if (!history.fault.empty())
        details.remark = fmt::format("Contacts are shown up to this event: {}.", one_line(history.fault, 300));
    return details;
}

}  // namespace polhode
