#include "experiment/run/search.h"

#include <fmt/format.h>

#include <chrono>
#include <mutex>
#include <thread>

#include "experiment/run/case.h"
#include "experiment/run/case_store.h"
#include "experiment/run/locks.h"
#include "experiment/run/progress.h"
#include "integrators/run/watch.h"
#include "text/claims.h"
#include "text/content_hash.h"
#include "text/parallel.h"

namespace polhode {

std::vector<Search> find_searches(const Plan& plan, const std::string& directory) {
    std::vector<Search> searches;
    for (std::size_t s = 0; s < plan.scenes.size(); ++s)
        for (const PlannedCurve& curve : plan.curves) {
            std::string identity = case_key(plan, plan.scenes[s], curve, 0);
            for (const double setting : curve.settings) identity += fmt::format(" {}", setting);
            std::string key = content_hash(identity);
            std::optional<Table> rows = load_rows(directory, key);
            searches.push_back({s, &curve, std::move(key), std::move(rows)});
        }
    return searches;
}

void run_searches(const Plan& plan, const RunOptions& options, std::vector<Search>& searches,
                  const std::function<void(std::size_t scene, bool needed)>& prepare,
                  const std::function<Table(std::size_t search)>& run) {
    const CaseSelection selection(plan, options);
    std::vector<std::size_t> pending;
    std::vector<bool> needed(plan.scenes.size());
    for (std::size_t i = 0; i < searches.size(); ++i) {
        const Search& search = searches[i];
        const auto curve = static_cast<std::size_t>(search.curve - plan.curves.data());
        if (search.rows || !selection.contains(search.scene, curve)) continue;
        pending.push_back(i), needed[search.scene] = true;
    }
    Progress progress(static_cast<long>(plan.scenes.size() + pending.size()), options.quiet);
    std::mutex progress_mutex;
    const auto advance = [&](const std::string& what) {
        const std::lock_guard lock(progress_mutex);
        progress.advance(what);
    };
    parallel_for(plan.scenes.size(), options.jobs, [&](std::size_t s) {
        if (sweep_interrupted()) return;
        const Stopwatch stopwatch;
        prepare(s, needed[s]);
        if (needed[s]) save_truth_duration(options.directory, plan, plan.scenes[s], stopwatch.seconds());
        advance(plan.scenes[s].label);
    });
    const Claims claims(claims_file(options.directory));
    const auto run_one = [&](std::size_t i) {
        Search& search = searches[pending[i]];
        if (sweep_interrupted()) return;
        const std::optional<Claims::Claim> claim = claims.take(search.key);
        if (!claim) return;
        search.rows = load_rows(options.directory, search.key);
        if (!search.rows) {
            const Stopwatch stopwatch;
            Table rows = run(pending[i]);
            if (sweep_interrupted()) return;
            // one search covers all planned settings of the curve
            const std::size_t settings = search.curve->settings.size();
            for (std::size_t rank = 0; rank < settings; ++rank)
                save_duration(options.directory,
                              describe_case(plan, Case{&plan.scenes[search.scene], search.curve, rank, search.key}),
                              stopwatch.seconds() / static_cast<double>(settings));
            save_rows(options.directory, search.key, rows);
            search.rows = std::move(rows);
        }
        advance(plan.scenes[search.scene].label + " " + std::string(search.curve->method->name));
    };
    // retry searches claimed by other processes: these either store the rows or release the claim
    while (!pending.empty() && !sweep_interrupted()) {
        const std::size_t before = pending.size();
        parallel_for(pending.size(), options.jobs, run_one);
        std::erase_if(pending, [&](std::size_t i) { return searches[i].rows.has_value(); });
        if (pending.size() == before && !sweep_interrupted())
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
}

}  // namespace polhode
