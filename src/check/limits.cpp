#include "check/limits.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "text/decimal.h"
#include "text/message.h"

namespace polhode {
namespace {

constexpr ErrorBlock blocks[] = {
    {"attitude", "attitude", "attitude", "rad", 0, 0.05},
    {"angular_velocity", "angular velocity", "omega", "rad/s", 0.05, 0.01},
    {"position", "position", "position", "m", 0.05, 0.01},
    {"velocity", "velocity", "velocity", "m/s", 0.05, 0.01},
    {"energy", "energy", "energy", "", 0.05, 0},
    {"momentum", "angular momentum", "momentum", "", 0.05, 0},
    {"joint_gap", "joint gap", "joint_gap", "m", 0, 0.01},
    {"joint_turn", "joint misalignment", "joint_turn", "rad", 0, 0.05},
};

std::size_t index_of(std::string_view name) {
    const auto found = std::ranges::find(blocks, name, &ErrorBlock::name);
    if (found == std::end(blocks)) throw std::invalid_argument(fmt::format("unknown block {}", name));
    return static_cast<std::size_t>(found - std::begin(blocks));
}

}  // namespace

std::span<const ErrorBlock> error_blocks() { return blocks; }

ErrorLimits::ErrorLimits(const Scene& scene) {
    for (std::size_t i = 0; i < limits_.size(); ++i) {
        const ErrorBlock& block = blocks[i];
        limits_[i] = {block.relative > 0 ? block.relative : block.absolute, block.relative > 0, "by default"};
        if (const std::optional<double> error = tolerated_error(scene, block.name))
            limits_[i] = {*error, block.unit.empty(), "tolerated by the scene"};
    }
}

void ErrorLimits::set(std::string_view name, std::string_view text) {
    const std::size_t i = index_of(name);
    const ErrorBlock& block = blocks[i];
    std::string option = "--max-" + std::string(name);
    std::ranges::replace(option, '_', '-');
    const bool percent = text.ends_with('%');
    const std::optional<double> value = parse_decimal(percent ? text.substr(0, text.size() - 1) : text);
    const std::string remedy =
        block.relative > 0 ? fmt::format("must be a number > 0{} or a percentage > 0 of the motion's size such as 5%",
                                         block.unit.empty() ? "" : fmt::format(" in {}", block.unit))
                           : fmt::format("must be a number > 0 in {}", block.unit);
    if (!value || !std::isfinite(*value) || !(*value > 0) || (percent && !(block.relative > 0)))
        throw std::invalid_argument(fmt::format("{}: \"{}\" is not valid; {}", option, one_line(text, 40), remedy));
    limits_[i] = {percent ? *value / 100 : *value, percent || block.unit.empty(), option};
}

const ErrorLimit& ErrorLimits::operator[](std::string_view block) const { return limits_[index_of(block)]; }

std::vector<BlockVerdict> ErrorLimits::verdicts(const FileErrors& file_errors) const {
    std::vector<BlockVerdict> all;
    for (std::size_t i = 0; i < limits_.size(); ++i) {
        const ErrorBlock& block = blocks[i];
        const std::size_t m = measure_index(block.measure);
        if (is_of_joints(block.name) && !file_errors[m]) continue;
        BlockVerdict v{&block, {}, {}, limits_[i], false};
        if (const std::optional<ErrorSummary>& error = file_errors[m]) {
            const bool is_relative = measures()[m].is_relative();
            const double size = file_errors.size[m];
            // energy and momentum are reported as relative errors
            v.error = is_relative && !block.unit.empty() && size > 0 ? error->max * size : error->max;
            if (is_relative)
                v.relative = error->max;
            else if (size > 0)
                v.relative = error->max / size;
            double allowed = v.limit.value * (v.limit.relative && !block.unit.empty() ? size : 1.0);
            // a body that hardly moves gets the absolute default
            if (v.limit.from == "by default") allowed = std::max(allowed, block.absolute);
            v.failed = !(*v.error <= allowed);
        }
        all.push_back(v);
    }
    return all;
}

bool ErrorLimits::refuses(const FileErrors& file_errors) const {
    return !report_only && std::ranges::any_of(verdicts(file_errors), &BlockVerdict::failed);
}

}  // namespace polhode
