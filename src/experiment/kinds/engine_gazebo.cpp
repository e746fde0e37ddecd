// Comparison with the published benchmark of Gazebo's boxes.
#include <cmath>

#include "experiment/kinds/curves.h"
#include "experiment/kinds/engines.h"

namespace polhode {
namespace {

/// S. Peters & J. Hsu 2014, Comparison of rigid body dynamic simulators for robotic simulation in Gazebo: the largest
/// |dL| / |L| over 10 s at h = 1e-3 s.
struct Published {
    const char* engine;
    double momentum;
};
constexpr Published gazebo_figures[] = {{"ode", 0.0131}, {"bullet", 0.0125}, {"simbody", 0.0064}};

Cell published_of(const std::string& engine) {
    for (const Published& one : gazebo_figures)
        if (engine == one.engine) return one.momentum;
    return {};
}

}  // namespace

NamedTable gazebo_table(const Plan& plan, const std::vector<Result>& rows) {
    NamedTable named = make_named_table("gazebo_boxes", "Gazebo's box of 10 kg, 10 s at 1/1000 s",
                                        {{"method", "method"},
                                         {"momentum_error", "largest |dL| / |L|"},
                                         {"published", "published in 2014"},
                                         {"energy_error", "energy"},
                                         {"attitude_error", "attitude (rad)"}});
    for (const PlannedScene& scene : plan.scenes) {
        if (scene.scene.name != "gazebo_box") continue;
        for (const PlannedCurve& curve : plan.curves) {
            if (curve.kind != SettingKind::step) continue;
            for (const Result* row : select_rows(rows, scene, curve)) {
                if (std::abs(row->setting / fine_step - 1) > 1e-6 || row->status != Status::ok) continue;
                const EngineMethod* engine = engine_of(*curve.method);
                named.table.rows.push_back({std::string(curve.method->name), cell_of(row->errors["momentum"].max),
                                            engine ? published_of(engine->engine) : Cell(),
                                            cell_of(row->errors["energy"].max), cell_of(row->errors["attitude"].max)});
            }
        }
    }
    return named;
}

}  // namespace polhode
