#include "check/error_over_time.h"

#include <fmt/format.h>

#include <algorithm>
#include <thread>

#include "check/file_errors.h"
#include "integrators/truth/dense.h"
#include "integrators/truth/reference.h"
#include "measure/scene_measure.h"
#include "text/parallel.h"

namespace polhode {
namespace {

constexpr std::size_t many = 2000;

// Lists the columns that the measure needs and the file lacks.
std::string lacking(const Scene& scene, const TrajectoryFile& file, const Measure& measure) {
    const bool center = (SceneMeasure<double>(scene).needs(measure) & known_center) != 0;
    const bool place = file.has_position || file.has_origin;
    std::vector<std::string> all;
    if (measure.whole_error)
        for (const std::string& name : missing_bodies(scene, file)) all.push_back("body \"" + name + '"');
    if ((measure.needs & known_angular_velocity) != 0 && !file.has_angular_velocity) all.emplace_back("wx,wy,wz");
    if (((measure.needs & known_position) != 0 || (center && !scene.pivot)) && !place) all.emplace_back("px,py,pz");
    if (((measure.needs & known_velocity) != 0 || (center && !scene.pivot)) && !file.has_velocity)
        all.emplace_back("vx,vy,vz");
    return fmt::format("{}", fmt::join(all, " and "));
}

ErrorOverTime by_polynomials(const Scene& scene, const TrajectoryFile& file, std::size_t measure,
                             const DenseTruth& truth) {
    constexpr std::size_t pieces = 16, at_once = 1024;
    const std::size_t rows = file.rows.size();
    std::vector<FileErrorAccumulator> accumulators;
    for (std::size_t i = 0; i < pieces; ++i) {
        accumulators.emplace_back(scene, file, ErrorArithmetic::binary64);
        accumulators.back().keep_row_errors(measure);
    }
    parallel_for(pieces, static_cast<int>(std::thread::hardware_concurrency()), [&](std::size_t i) {
        std::vector<ReferenceSample> samples;
        const std::size_t end = rows * (i + 1) / pieces;
        for (std::size_t first = rows * i / pieces; first < end; first += samples.size()) {
            samples.clear();
            for (std::size_t k = first; k < std::min(first + at_once, end); ++k)
                samples.push_back(truth.at(file.rows[k].t));
            accumulators[i].add(first, samples);
        }
    });
    for (std::size_t i = 1; i < pieces; ++i) accumulators[0].append(accumulators[i]);
    ErrorOverTime result;
    for (const TrajectoryRow& row : file.rows) result.t.push_back(row.t);
    result.error = accumulators[0].row_errors();
    return result;
}

}  // namespace

ErrorOverTime error_over_time(const Scene& scene, const TrajectoryFile& file, std::string_view measure,
                              const std::string& name) {
    const std::size_t index = measure_index(measure);
    if (const std::string missing = lacking(scene, file, measures()[index]); !missing.empty())
        throw InputError(name, "", fmt::format("has no {}, needed for the error of {}", missing, measure),
                         "add them, or choose another error");
    const std::size_t at_once = file.bodies_at_once(), moments = file.rows.size() / at_once;
    if (moments > many && file.rows.back().t > 0)
        if (const DenseTruth truth = dense_reference(scene, file.rows.back().t); truth.available)
            return by_polynomials(scene, file, index, truth);

    TrajectoryFile picked = file;
    picked.rows.clear();
    ErrorOverTime result;
    const std::size_t count = std::min(many, moments);
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t k = count > 1 ? i * (moments - 1) / (count - 1) : 0;
        result.t.push_back(file.rows[k * at_once].t);
        for (std::size_t b = 0; b < at_once; ++b) picked.rows.push_back(file.rows[k * at_once + b]);
    }
    const Reference truth = reference(scene, result.t);
    if (!truth.available) {
        result.fault = truth.message;
        return result;
    }
    FileErrorAccumulator accumulator(scene, picked, ErrorArithmetic::binary128);
    accumulator.keep_row_errors(index);
    accumulator.add(0, truth.samples);
    result.error = accumulator.row_errors();
    return result;
}

}  // namespace polhode
