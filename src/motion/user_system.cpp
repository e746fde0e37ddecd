#include "motion/user_system.h"

#include <algorithm>
#include <cmath>

#include "motion/contact.h"

namespace polhode {

Problem pose_model(std::shared_ptr<const ErasedModel> model, double duration) {
    const char* name = "user-defined system";
    const auto demand = [&](bool right, const char* place, const char* fault, const char* remedy) {
        if (!right) throw InputError(name, place, fault, remedy);
    };
    const auto positive = [](double x) { return std::isfinite(x) && x > 0; };
    demand(positive(duration), "duration", "is not finite and positive", "give a time in s, > 0");
    demand(model->dimension() > 0, "dimension", "is below 1", "give the number of components");
    const std::size_t n = static_cast<std::size_t>(model->dimension());
    const std::vector<double> scales = model->scales();
    demand(scales.size() == n && std::all_of(scales.begin(), scales.end(), positive), "scales",
           "are not one finite, positive number per component", "give the typical magnitude of each component");
    std::vector<double> y(n);
    model->initial(y.data());
    demand(!model->motion(y.data()).empty(), "motion", "is empty", "return one sample per body");

    Problem problem;
    problem.scene.name = name, problem.scene.duration = duration;
    problem.needs.system = SystemKind::user_defined, problem.needs.dimension = model->dimension();
    std::vector<double> times{0};
    for (double t : model->events()) {
        demand(std::isfinite(t) && t >= 0, "events", "contain a time that is not finite or is negative",
               "give times in s, >= 0");
        if (t <= duration) times.push_back(t);
    }
    std::sort(times.begin(), times.end());
    times.erase(std::unique(times.begin(), times.end()), times.end());
    times.push_back(duration);
    problem.segments.resize(times.size() - 1);
    for (std::size_t i = 0; i + 1 < times.size(); ++i) {
        Segment& segment = problem.segments[i];
        segment.index = i, segment.begin = times[i], segment.end = times[i + 1], segment.last = i + 2 == times.size();
    }
    problem.needs.time_dependent = problem.segments.size() > 1;
    problem.body.geometry = std::make_shared<const ContactGeometry<double>>();
    problem.system = UserSystem{std::move(model)};
    return problem;
}

}  // namespace polhode
