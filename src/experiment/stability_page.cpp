// The findings in plain words.
#include <fmt/format.h>

#include "experiment/stability_tables.h"

namespace polhode {

std::string stability_page(const Plan& plan, const StabilityFindings& found, const std::vector<NamedTable>& tables) {
    std::string page = fmt::format("# Numerical stability\n\n{}\n", plan.experiment.about);
    for (const NamedTable& named : tables)
        if (named.name == "outcomes") page += fmt::format("\n{}", markdown(named.table));
    page += fmt::format("\n{} scenes\n", found.scenes.size());
    return page;
}

}  // namespace polhode
