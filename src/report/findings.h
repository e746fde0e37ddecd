// The main findings of a result directory, as sentences with numbers.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "report/folder.h"

namespace polhode {

/// One finding.
struct Finding {
    std::string title;  ///< a sentence
    std::string text;   ///< supporting numbers
    std::string link;   ///< URL fragment of the view that shows it, "#section=..&scene=.."
};

/// The fastest run of a scene within an attitude error, and the fastest run of another method.
struct Fastest {
    std::optional<std::size_t> row, runner_up;  ///< indices into the directory's rows
};

/// Finds the fastest run, by median time, among `rows` (indices, all of one scene) with a largest attitude error of at
/// most `error` (rad). Considers only the reduced formulation if the directory has runs with it.
Fastest fastest_within(const ResultFolder& folder, const std::vector<std::size_t>& rows, double error);

/// Row indices of each scene, by the index of the scene.
std::vector<std::vector<std::size_t>> rows_by_scene(const ResultFolder& folder);

/// The first three of: the fastest method; lost attitudes that the energy error hides; growth of energy errors; orders
/// that differ from the claimed ones; failed runs; methods that reach the rounding floor; the gain of the reduced
/// formulation. Findings without data are omitted.
std::vector<Finding> make_findings(const ResultFolder& folder);

/// Growth exponent and its uncertainty for each of standard_measures; nullopt if no power law fits.
std::vector<std::optional<std::pair<double, double>>> fit_growth(const FolderSeries& series);

/// Order of convergence fitted to one curve.
struct FittedOrder {
    int experiment = 0, scene = 0, method = 0;
    SettingKind kind = SettingKind::none;
    int claimed = 0;                    ///< 0 if the method claims no order
    std::optional<double> observed;     ///< empty if the errors do not converge
    int points = 0;                     ///< number of fitted points
    double from = absent, to = absent;  ///< settings of the fitted points
};

/// Fits orders to all curves that have at least four successful runs with an error above 100 times the rounding floor.
/// Uses the experiments of kind `convergence`, or all experiments if there are none.
std::vector<FittedOrder> fit_orders(const ResultFolder& folder);

}  // namespace polhode
