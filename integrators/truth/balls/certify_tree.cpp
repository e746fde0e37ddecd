#include <algorithm>
#include <cmath>
#include <utility>

#include "integrators/truth/balls/certify.h"
#include "integrators/truth/balls/flow.h"
#include "integrators/truth/tree_form.h"
#include "motion/itinerary.h"
#include "motion/mechanism.h"

namespace polhode::truth {

// Errors are measured by the size of each coordinate: which norm it is matters little where parallelepipeds carry them.
void TreeCertifier::make_plan() {
    // what the bounds of a right-hand side lose by taking each of its numbers by its size alone, a link
    constexpr double parallelepiped_bits = 24, bits_a_link = 6;
    const Problem problem = pose(scene_);
    const MechanismModel& mechanism = mechanism_of(problem);
    const TreeForm<double> form(scene_);
    plan_.dimension = form.dimension();
    plan_.scales = mechanism.scales();
    plan_.blocks = form.blocks(plan_.scales);
    const auto n = static_cast<std::size_t>(plan_.dimension);
    plan_.weights.assign(n * n, 0);
    for (std::size_t i = 0; i < n; ++i) plan_.weights[i * n + i] = 1 / plan_.scales[i];
    lost_bits_ =
        parallelepiped_bits + bits_a_link * static_cast<double>(form.tree().links().links.size()) + kappa_bits(problem);
}

CertifiedAttempt TreeCertifier::attempt() {
    CertifiedAttempt result;
    result.by_parallelepiped = true;
    result.most_bits = most_series_bits;
    const auto bits = static_cast<double>(Ball::precision());
    if (plan_.dimension == 0) make_plan();
    if (least_bits_ + lost_bits_ > bits) {
        result.fault = "errors grow", result.wanted_bits = least_bits_ + lost_bits_;
        return result;
    }
    TreeForm<Ball> form(scene_);
    std::vector<Ball> y(static_cast<std::size_t>(form.dimension()));
    form.initial(y.data());
    SampleQueue samples(times_);
    const auto note = [&](const std::vector<Ball>& state) {
        for (const Motion<Ball>& body : form.motion(state.data())) result.columns.push_back(columns_of(body));
        return true;
    };
    const auto enter = [&](const Leg& leg) {
        form.enter(leg.begin, y.data());
        return true;
    };
    const std::vector<Leg> legs = itinerary(scene_);
    follow(
        legs, samples, enter, [&](double) { return note(y); },
        [&](const Leg& leg) {
            Piece piece(record<Ball>(form, form.dimension()), leg.begin, leg.end, {});
            for (; samples.in(leg); samples.pop()) piece.sample_times.push_back(samples.front());
            Enclosure enclosure = enclose_by_taylor(piece, plan_, y, Carry::parallelepiped);
            result.steps += enclosure.steps;
            result.fault = enclosure.fault, result.hopeless = enclosure.hopeless;
            if (!result.fault.empty()) {
                result.wanted_bits = 1.3 * bits + 64;
                return false;
            }
            for (const std::vector<Ball>& state : enclosure.samples) note(state);
            y = std::move(enclosure.end);
            return true;
        });
    return result;
}

}  // namespace polhode::truth
