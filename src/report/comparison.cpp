#include "report/comparison.h"

#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <map>
#include <tuple>

namespace polhode {
namespace {

using Key = std::tuple<std::string, std::string, std::string, int, double, std::string>;

Key key_of(const ResultFolder& folder, const FolderRow& row) {
    return {folder.experiments[static_cast<std::size_t>(row.experiment)].name,
            folder.scenes[row.scene],
            folder.methods[row.method],
            static_cast<int>(row.kind),
            std::isfinite(row["setting"]) ? row["setting"] : -1,
            folder.formulations[row.formulation]};
}

double mean(const std::vector<double>& values) {
    double sum = 0;
    for (const double value : values) sum += value;
    return sum / static_cast<double>(values.size());
}

}  // namespace

RatioInterval ratio_interval(const std::vector<std::vector<double>>& groups) {
    std::vector<double> means;
    for (const std::vector<double>& ratios : groups) {
        if (ratios.empty()) continue;
        std::vector<double> logarithms;
        for (const double ratio : ratios) logarithms.push_back(std::log(ratio));
        means.push_back(mean(logarithms));
    }
    RatioInterval interval;
    interval.groups = static_cast<int>(means.size());
    if (means.empty()) return interval;
    const double center = mean(means), n = static_cast<double>(means.size());
    interval.ratio = std::exp(center);
    if (means.size() < 3) return interval;
    double squares = 0;
    for (const double one : means) squares += (one - center) * (one - center);
    // Without promotion to long double: its tables are initialised before main, which throws if long double is no wider
    // than double.
    using InBinary64 = boost::math::policies::policy<boost::math::policies::promote_double<false>>;
    const boost::math::students_t_distribution<double, InBinary64> distribution(n - 1);
    const double half =
        boost::math::quantile(boost::math::complement(distribution, 0.025)) * std::sqrt(squares / (n - 1) / n);
    interval.low = std::exp(center - half), interval.high = std::exp(center + half);
    return interval;
}

FolderComparison compare_folders(const ResultFolder& here, const ResultFolder& there) {
    std::map<Key, std::size_t> others;
    for (std::size_t r = 0; r < there.rows.size(); ++r) others.try_emplace(key_of(there, there.rows[r]), r);
    FolderComparison comparison;
    std::map<int, std::map<int, std::vector<double>>> by_method;
    std::map<int, std::vector<double>> by_scene;
    std::map<int, std::vector<double>> errors;
    std::map<int, std::size_t> pairs;
    for (std::size_t r = 0; r < here.rows.size(); ++r) {
        const FolderRow& row = here.rows[r];
        const auto found = others.find(key_of(here, row));
        if (found == others.end()) {
            ++comparison.only_here;
            continue;
        }
        const FolderRow& other = there.rows[found->second];
        comparison.pairs.push_back({r, found->second});
        others.erase(found);
        if (row.attitude() == other.attitude() || (std::isnan(row.attitude()) && std::isnan(other.attitude())))
            ++comparison.same_bits;
        if (!(row.seconds() > 0 && other.seconds() > 0)) continue;
        ++pairs[row.method];
        by_method[row.method][row.scene].push_back(other.seconds() / row.seconds());
        by_scene[row.scene].push_back(other.seconds() / row.seconds());
        if (row.attitude() > 0 && other.attitude() > 0)
            errors[row.method].push_back(std::log(other.attitude() / row.attitude()));
    }
    comparison.only_there = others.size();
    const auto groups = [](const std::map<int, std::vector<double>>& of) {
        std::vector<std::vector<double>> list;
        for (const auto& [scene, ratios] : of) list.push_back(ratios);
        return list;
    };
    for (const auto& [method, scenes] : by_method) {
        FolderComparison::MethodComparison one{method, pairs[method], ratio_interval(groups(scenes)), {}};
        if (!errors[method].empty()) one.errors = std::exp(mean(errors[method]));
        comparison.methods.push_back(one);
    }
    comparison.all = ratio_interval(groups(by_scene));
    return comparison;
}

}  // namespace polhode
