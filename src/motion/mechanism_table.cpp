#include "motion/mechanism_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "text/csv_lines.h"
#include "text/decimal.h"
#include "text/json_document.h"
#include "text/message.h"

namespace polhode {
namespace {

constexpr std::size_t largest_table = std::size_t{4} << 30, longest_name = 200;

// The columns of one joint or body.
class ColumnMaker {
  public:
    ColumnMaker(std::vector<MechanismColumn>& all, std::string owner) : all_(all), owner_(std::move(owner)) {}

    template <class Number>
    void alone(const char* name, Number number, std::function<void(Scene&)> prepare = {}) {
        all_.push_back({owner_ + "." + name, owner_ + "." + name, std::move(number), std::move(prepare), true});
    }
    // what the mechanism is, not how it starts
    template <class Number>
    void constant(const char* name, Number number, std::function<void(Scene&)> prepare = {}) {
        alone(name, std::move(number), std::move(prepare));
        all_.back().is_start = false;
    }
    // `part(scene, i)` of a block
    template <class Part>
    void block(std::initializer_list<const char*> names, Part part) {
        std::vector<std::string> full;
        for (const char* name : names) full.push_back(owner_ + "." + name);
        const std::string block = fmt::format("{}", fmt::join(full, ","));
        for (std::size_t i = 0; i < full.size(); ++i)
            all_.push_back({full[i], block, [part, i](Scene& scene) -> double& { return part(scene, i); }, {}, true});
    }

  private:
    std::vector<MechanismColumn>& all_;
    std::string owner_;
};

double& part_of(Quaternion<double>& q, std::size_t i) { return i == 0 ? q.w : i == 1 ? q.x : i == 2 ? q.y : q.z; }

void add_joint(std::vector<MechanismColumn>& all, const Scene& scene, std::size_t j) {
    ColumnMaker make(all, scene.joints[j].name);
    const auto number = [j](std::array<double, 2> Joint::*member, std::size_t i) {
        return [j, member, i](Scene& s) -> double& { return (s.joints[j].*member)[i]; };
    };
    const auto one_coordinate = [&](const char* coordinate, const char* rate) {
        make.alone(coordinate, number(&Joint::coordinate, 0)), make.alone(rate, number(&Joint::rate, 0));
        make.constant("stiffness", number(&Joint::stiffness, 0)), make.constant("rest", number(&Joint::rest, 0));
        make.constant("damping", number(&Joint::damping, 0));
    };
    switch (scene.joints[j].type) {
        case JointType::revolute:
            one_coordinate("angle", "rate");
            break;
        case JointType::prismatic:
            one_coordinate("displacement", "speed");
            break;
        case JointType::universal:
            make.alone("angle1", number(&Joint::coordinate, 0)), make.alone("angle2", number(&Joint::coordinate, 1));
            make.alone("rate1", number(&Joint::rate, 0)), make.alone("rate2", number(&Joint::rate, 1));
            break;
        case JointType::spherical:
            make.block({"qw", "qx", "qy", "qz"},
                       [j](Scene& s, std::size_t i) -> double& { return part_of(s.joints[j].orientation, i); });
            make.block({"wx", "wy", "wz"}, [j](Scene& s, std::size_t i) -> double& {
                return s.joints[j].angular_velocity[static_cast<int>(i)];
            });
            break;
        case JointType::fixed:
            break;
    }
}

void add_body(std::vector<MechanismColumn>& all, const Scene& scene, std::size_t b) {
    const std::string& name = scene.bodies[b].name;
    ColumnMaker make(all, name);
    // what it is made of says no more what its mass is
    make.constant(
        "mass", [b](Scene& s) -> double& { return s.bodies[b].body.mass; },
        [b](Scene& s) { s.bodies[b].body.source = nullptr; });
    if (std::ranges::any_of(scene.joints, [&](const Joint& joint) { return joint.child == name; })) return;
    make.block({"qw", "qx", "qy", "qz"},
               [b](Scene& s, std::size_t i) -> double& { return part_of(s.bodies[b].initial.orientation, i); });
    const auto vector = [&](std::initializer_list<const char*> names, Vector3<double> Initial::*member) {
        make.block(names, [b, member](Scene& s, std::size_t i) -> double& {
            return (s.bodies[b].initial.*member)[static_cast<int>(i)];
        });
    };
    vector({"wx", "wy", "wz"}, &Initial::angular_velocity);
    vector({"px", "py", "pz"}, &Initial::position_W);
    vector({"vx", "vy", "vz"}, &Initial::velocity_W);
}

// One file, line by line.
class MechanismTableReader {
  public:
    MechanismTableReader(std::string_view text, const std::string& file, const Scene& scene)
        : lines_(text, file), file_(file), scene_(scene), known_(mechanism_columns(scene)) {}

    MechanismTable read() {
        if (!lines_.next())
            fail("", "is empty",
                 fmt::format("give a header line such as {} and one line per start", known_.front().name));
        header();
        for (std::size_t number = 1; lines_.next(); ++number) {
            const std::size_t numbers = result_.numbers.size(), ids = result_.ids.size();
            try {
                row();
                result_.row_numbers.push_back(number);
                validate(result_.scene_of(scene_, result_.rows() - 1), fmt::format("{}: {}", file_, here()));
            } catch (const InputError& fault) {
                result_.numbers.resize(numbers), result_.ids.resize(ids);
                if (!result_.row_numbers.empty() && result_.row_numbers.back() == number)
                    result_.row_numbers.pop_back();
                result_.refused.push_back({number, fault.what()});
            }
        }
        if (result_.rows() == 0 && !result_.refused.empty())
            fail("", "has no valid row", "first error: " + result_.refused.front().fault);
        if (result_.rows() == 0) fail("", "has a header but no rows", "give one line per start");
        return std::move(result_);
    }

  private:
    [[noreturn]] void fail(const std::string& place, const std::string& fault, const std::string& remedy) const {
        throw InputError(file_, place, fault, remedy);
    }
    std::string here() const { return fmt::format("line {}", lines_.number()); }

    void header() {
        std::vector<std::string> names{"id"};
        for (const MechanismColumn& column : known_) names.push_back(column.name);
        std::set<std::string> there, blocks;
        for (const std::size_t place : lines_.header(names)) {
            places_.push_back(place);
            if (place == 0) continue;
            result_.columns.push_back(known_[place - 1]);
            there.insert(result_.columns.back().name), blocks.insert(result_.columns.back().block);
        }
        if (result_.columns.empty())
            fail(here(), "has no column but id",
                 fmt::format("give at least one other column, such as {}", known_.front().name));
        for (const MechanismColumn& column : known_)
            if (blocks.contains(column.block) && !there.contains(column.name))
                fail(here(), fmt::format("column {} is missing", column.name),
                     fmt::format("give all of {} or none", column.block));
    }

    void row() {
        const auto& cells = lines_.cells();
        if (cells.size() != places_.size())
            fail(here(), fmt::format("has {} cells under {} columns", cells.size(), places_.size()),
                 "give one cell per column");
        for (std::size_t i = 0; i < cells.size(); ++i) {
            const std::string at =
                fmt::format("{}, column {}", here(), places_[i] == 0 ? "id" : known_[places_[i] - 1].name);
            if (places_[i] == 0) {
                const std::string_view id = cells[i];
                if (id.size() > longest_name || first_invalid_utf8(id) != std::string_view::npos ||
                    one_line(id, id.size()) != id || id.find('"') != id.npos)
                    fail(at, "is longer than 200 bytes, not UTF-8, or contains quotes or control characters",
                         "use short printable text");
                result_.ids.emplace_back(id);
                continue;
            }
            const std::optional<double> value = parse_decimal(cells[i]);
            if (!value)
                fail(at, cells[i].empty() ? "is empty" : one_line(cells[i], 60) + " is not a number",
                     "give a decimal number such as -1.5e-3");
            if (!std::isfinite(*value)) fail(at, one_line(cells[i], 60) + " is not finite", "give a finite number");
            result_.numbers.push_back(*value);
        }
    }

    CsvLines lines_;
    const std::string& file_;
    const Scene& scene_;
    const std::vector<MechanismColumn> known_;
    std::vector<std::size_t> places_;  // of each cell: 0 the id, else 1 + that in known_
    MechanismTable result_;
};

}  // namespace

std::vector<MechanismColumn> mechanism_columns(const Scene& scene) {
    std::vector<MechanismColumn> all;
    for (std::size_t j = 0; j < scene.joints.size(); ++j) add_joint(all, scene, j);
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) add_body(all, scene, b);
    return all;
}

bool MechanismTable::only_starts() const {
    return std::ranges::all_of(columns, [](const MechanismColumn& column) { return column.is_start; });
}

Scene MechanismTable::scene_of(const Scene& scene, std::size_t k) const {
    Scene row = scene;
    for (std::size_t i = 0; i < columns.size(); ++i) {
        if (columns[i].prepare) columns[i].prepare(row);
        columns[i].number(row) = numbers[k * columns.size() + i];
    }
    return row;
}

MechanismTable parse_mechanism_table(std::string_view text, const std::string& file, const Scene& scene) {
    return MechanismTableReader(text, file, scene).read();
}

MechanismTable read_mechanism_table(const std::string& path, const Scene& scene) {
    return parse_mechanism_table(read_text(path, largest_table, "a readable CSV file"), path, scene);
}

}  // namespace polhode
