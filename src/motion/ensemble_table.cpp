// The strict reader of ensemble tables.
#include "motion/ensemble_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "body/fast_principal_frame.h"
#include "text/csv_lines.h"
#include "text/decimal.h"
#include "text/json_document.h"
#include "text/message.h"

namespace polhode {
namespace {

constexpr std::size_t largest_file = std::size_t{4} << 30, longest_id = 200;
constexpr double norm_tolerance = 1e-6, shape_tolerance = 1e-12;

bool is_diagonal(const Matrix3<double>& J) {
    return J[0][1] == 0 && J[0][2] == 0 && J[1][2] == 0 && J[1][0] == 0 && J[2][0] == 0 && J[2][1] == 0;
}

struct Column {
    const char* name;
    void (*put)(EnsembleBody&, double);  // nullptr: the id
    int block;                           // columns of one block stand together
};

enum Block { block_q, block_w, block_p, block_v, block_moments, block_products, block_mass, block_id, blocks };
constexpr const char* block_names[blocks] = {"qw,qx,qy,qz", "wx,wy,wz",    "px,py,pz", "vx,vy,vz",
                                             "ixx,iyy,izz", "ixy,ixz,iyz", "mass",     "id"};

const std::vector<Column>& known_columns() {
    using B = EnsembleBody;
    static const std::vector<Column> columns{
        {"qw", [](B& b, double x) { b.orientation.w = x; }, block_q},
        {"qx", [](B& b, double x) { b.orientation.x = x; }, block_q},
        {"qy", [](B& b, double x) { b.orientation.y = x; }, block_q},
        {"qz", [](B& b, double x) { b.orientation.z = x; }, block_q},
        {"wx", [](B& b, double x) { b.angular_velocity[0] = x; }, block_w},
        {"wy", [](B& b, double x) { b.angular_velocity[1] = x; }, block_w},
        {"wz", [](B& b, double x) { b.angular_velocity[2] = x; }, block_w},
        {"px", [](B& b, double x) { b.position_W[0] = x; }, block_p},
        {"py", [](B& b, double x) { b.position_W[1] = x; }, block_p},
        {"pz", [](B& b, double x) { b.position_W[2] = x; }, block_p},
        {"vx", [](B& b, double x) { b.velocity_W[0] = x; }, block_v},
        {"vy", [](B& b, double x) { b.velocity_W[1] = x; }, block_v},
        {"vz", [](B& b, double x) { b.velocity_W[2] = x; }, block_v},
        {"ixx", [](B& b, double x) { b.inertia_B[0][0] = x; }, block_moments},
        {"iyy", [](B& b, double x) { b.inertia_B[1][1] = x; }, block_moments},
        {"izz", [](B& b, double x) { b.inertia_B[2][2] = x; }, block_moments},
        {"ixy", [](B& b, double x) { b.inertia_B[0][1] = b.inertia_B[1][0] = x; }, block_products},
        {"ixz", [](B& b, double x) { b.inertia_B[0][2] = b.inertia_B[2][0] = x; }, block_products},
        {"iyz", [](B& b, double x) { b.inertia_B[1][2] = b.inertia_B[2][1] = x; }, block_products},
        {"mass", [](B& b, double x) { b.mass = x; }, block_mass},
        {"id", nullptr, block_id},
    };
    return columns;
}

// One file, line by line.
class Reader {
  public:
    Reader(std::string_view text, const std::string& file, const Scene& scene)
        : lines_(text, file), file_(file), scene_(scene), start_(ensemble_body(scene)) {}

    EnsembleTable read(BadRows bad) {
        if (!lines_.next())
            fail("", "is empty", "give a header line such as qw,qx,qy,qz,wx,wy,wz and a line for each body");
        header();
        while (lines_.next()) {
            if (result_.bodies.empty()) {
                const std::size_t rows = lines_.rows_left();
                result_.bodies.reserve(rows);
                if (has_id_) result_.ids.reserve(rows);
            }
            const std::size_t bodies = result_.bodies.size(), ids = result_.ids.size();
            try {
                body();
            } catch (const InputError& fault) {
                if (bad == BadRows::refuse_all) throw;
                result_.bodies.resize(bodies), result_.ids.resize(ids);
                result_.refused.push_back({bodies + result_.refused.size() + 1, fault.what()});
            }
        }
        if (result_.bodies.empty() && !result_.refused.empty())
            fail("", "has no row that is a body", "the first: " + result_.refused.front().fault);
        if (result_.bodies.empty()) fail("", "has a header and no row", "give a line for each body");
        return std::move(result_);
    }

  private:
    [[noreturn]] void fail(const std::string& place, const std::string& fault, const std::string& remedy) const {
        throw InputError(file_, place, fault, remedy);
    }
    std::string here() const { return fmt::format("line {}", lines_.number()); }
    std::string at(std::size_t column) const {
        return fmt::format("line {}, column {}", lines_.number(), columns_[column]->name);
    }

    void header() {
        std::vector<std::string> names;
        for (const Column& known : known_columns()) names.emplace_back(known.name);
        int seen[blocks] = {};
        for (const std::size_t place : lines_.header(names)) {
            columns_.push_back(&known_columns()[place]);
            ++seen[columns_.back()->block];
        }
        for (const Column& known : known_columns()) {
            if (seen[known.block] == 0 || std::find(columns_.begin(), columns_.end(), &known) != columns_.end())
                continue;
            fail(here(), fmt::format("column {} is missing", known.name),
                 fmt::format("give all of {}, or none", block_names[known.block]));
        }
        has_id_ = seen[block_id] > 0;
        if (has_id_ && columns_.size() == 1)
            fail(here(), "has no column but id", "give at least one of qw,qx,qy,qz, wx,wy,wz, ixx,iyy,izz, mass, ..");
        if (seen[block_products] > 0 && seen[block_moments] == 0)
            fail(here(), "has products of inertia without moments", "give ixx,iyy,izz beside ixy,ixz,iyz");
        if (scene_.pivot && (seen[block_p] > 0 || seen[block_v] > 0))
            fail(here(),
                 fmt::format("has columns {} in a scene with a pivot", block_names[seen[block_p] ? block_p : block_v]),
                 "leave them out: the pivot and the attitude say where the centre of mass is");
        // moments without products: about the body's own axes
        if (seen[block_moments] > 0) start_.inertia_B = {};
    }

    void body() {
        const auto& cells = lines_.cells();
        if (cells.size() != columns_.size())
            fail(here(), fmt::format("has {} cells under {} columns", cells.size(), columns_.size()),
                 "give a cell for each column");
        EnsembleBody& b = result_.bodies.emplace_back(start_);
        for (std::size_t i = 0; i < cells.size(); ++i) {
            if (columns_[i]->put == nullptr) {
                identify(i, cells[i]);
                continue;
            }
            const std::optional<double> value = parse_decimal(cells[i]);
            if (!value)
                fail(at(i), cells[i].empty() ? "is empty" : one_line(cells[i], 60) + " is no number",
                     "give a decimal number such as -1.5e-3");
            if (!std::isfinite(*value)) fail(at(i), one_line(cells[i], 60) + " is not finite", "give a finite number");
            columns_[i]->put(b, *value);
        }
        if (const auto fault = fault_of(b, scene_.pivot.has_value()))
            fail(fmt::format("{}, {} {}", here(), fault->columns.find(',') == std::string::npos ? "column" : "columns",
                             fault->columns),
                 fault->fault, fault->remedy);
    }

    void identify(std::size_t i, std::string_view cell) {
        if (cell.size() > longest_id) fail(at(i), "has more than 200 bytes", "give shorter ids");
        if (first_invalid_utf8(cell) != std::string_view::npos) fail(at(i), "is not UTF-8", "give UTF-8");
        if (one_line(cell, cell.size()) != cell || cell.find('"') != cell.npos)
            fail(at(i), one_line(cell, 60) + " holds quotes or control characters", "give plain text without commas");
        result_.ids.emplace_back(cell);
    }

    CsvLines lines_;
    const std::string& file_;
    const Scene& scene_;
    EnsembleBody start_;
    bool has_id_ = false;
    std::vector<const Column*> columns_;  // in the file's order
    EnsembleTable result_;
};

}  // namespace

EnsembleBody ensemble_body(const Scene& scene) {
    return {scene.body.mass,           scene.body.inertia_B,
            scene.initial.orientation, scene.initial.angular_velocity,
            scene.initial.position_W,  scene.initial.velocity_W};
}

std::optional<BodyFault> fault_of(const EnsembleBody& b, bool pivoted) {
    const auto finite = [](double x) { return x * 0 == 0; };
    const auto all_finite = [&](const Vector3<double>& x) { return finite(x[0]) && finite(x[1]) && finite(x[2]); };
    if (!(b.mass > 0) || !finite(b.mass) || !finite(1 / b.mass))
        return BodyFault{"mass", "is " + shortest_decimal(b.mass), "the mass must be finite and > 0"};
    const Quaternion<double>& q = b.orientation;
    const double norm = std::sqrt(squared_norm(q));
    if (!(std::abs(norm - 1) <= norm_tolerance))
        return BodyFault{"qw,qx,qy,qz", "have norm " + shortest_decimal(norm),
                         "a unit quaternion w, x, y, z has norm 1 within 1e-6"};
    if (!all_finite(b.angular_velocity)) return BodyFault{"wx,wy,wz", "are not finite", "give finite numbers"};
    if (!all_finite(b.position_W)) return BodyFault{"px,py,pz", "are not finite", "give finite numbers"};
    if (!all_finite(b.velocity_W)) return BodyFault{"vx,vy,vz", "are not finite", "give finite numbers"};
    if (pivoted && !(b.position_W == Vector3<double>() && b.velocity_W == Vector3<double>()))
        return BodyFault{"px,py,pz,vx,vy,vz", "stand beside a pivot",
                         "leave them out: the pivot and the attitude say where the centre of mass is"};

    const Matrix3<double>& J = b.inertia_B;
    const bool own_axes = is_diagonal(J);
    const char* const columns = own_axes ? "ixx,iyy,izz" : "ixx,iyy,izz,ixy,ixz,iyz";
    for (int i = 0; i < 3; ++i)
        if (!all_finite(J[i])) return BodyFault{columns, "are not finite", "give finite numbers"};
    Vector3<double> I(J[0][0], J[1][1], J[2][2]);
    if (!own_axes) I = fast_principal_frame(J).moments;
    const double largest = std::max({std::abs(I[0]), std::abs(I[1]), std::abs(I[2])});
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < i; ++j)
            if (!(std::abs(J[i][j] - J[j][i]) <= shape_tolerance * largest))
                return BodyFault{columns, "are not symmetric", "an inertia tensor is symmetric"};
    for (int i = 0; i < 3; ++i) {
        if (!(I[i] > 0) || !finite(I[i]) || !finite(1 / I[i]))
            return BodyFault{columns, fmt::format("make the principal moment {}", shortest_decimal(I[i])),
                             "every principal moment must be finite and > 0"};
        const double others = I[(i + 1) % 3] + I[(i + 2) % 3];
        if (!(I[i] - others <= shape_tolerance * largest))
            return BodyFault{columns,
                             fmt::format("make a principal moment {}, more than the sum {} of the other two",
                                         shortest_decimal(I[i]), shortest_decimal(others)),
                             "moments of inertia keep the triangle inequality within 1e-12 of the largest"};
    }
    return {};
}

EnsembleTable parse_ensemble(std::string_view text, const std::string& file, const Scene& scene, BadRows bad) {
    return Reader(text, file, scene).read(bad);
}

EnsembleTable read_ensemble(const std::string& path, const Scene& scene, BadRows bad) {
    return parse_ensemble(read_text(path, largest_file, "a readable CSV file"), path, scene, bad);
}

}  // namespace polhode
