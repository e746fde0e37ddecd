#include "motion/itinerary.h"

#include <algorithm>

#include "scene/scene_formulas.h"

namespace polhode {

std::vector<double> event_times(const Scene& scene) {
    std::vector<double> times{0, scene.duration};
    bool impulse_at_end = false;
    const auto note = [&](double t) {
        if (t > 0 && t < scene.duration) times.push_back(t);
    };
    for (const Load& load : scene.loads) {
        const Window window = window_of(load);
        note(window.from);
        note(window.until);
        if (const auto* impulse = std::get_if<Impulse>(&load)) {
            note(impulse->at);
            impulse_at_end = impulse_at_end || impulse->at == scene.duration;
        }
    }
    for (const double t : sampling_times(scene)) note(t);
    std::sort(times.begin(), times.end());
    times.erase(std::unique(times.begin(), times.end()), times.end());
    // an impulse at the end of the run opens a segment of length zero, so that the last sample shows the motion after
    // it
    if (impulse_at_end) times.push_back(scene.duration);
    return times;
}

std::vector<Leg> itinerary(const Scene& scene) {
    const std::vector<double> times = event_times(scene);
    std::vector<Leg> legs;
    for (std::size_t i = 0; i + 1 < times.size(); ++i)
        legs.push_back({i, times[i], times[i + 1], i + 2 == times.size()});
    return legs;
}

}  // namespace polhode
