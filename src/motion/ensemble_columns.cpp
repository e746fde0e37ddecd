#include "motion/ensemble_columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "motion/ensemble_stream.h"
#include "text/message.h"

namespace polhode {
namespace {

constexpr std::size_t longest_id = 200;

constexpr const char *block_q = "qw,qx,qy,qz", *block_w = "wx,wy,wz", *block_p = "px,py,pz", *block_v = "vx,vy,vz",
                     *block_moments = "ixx,iyy,izz", *block_products = "ixy,ixz,iyz", *block_mass = "mass";

struct BodyColumn {
    const char* name;
    void (*put)(EnsembleBody&, double);  // sets a body's number
    const char* block;
};

using B = EnsembleBody;
constexpr BodyColumn body_columns[] = {
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
};

// One member of each column.
template <class Columns, class Member>
std::vector<std::string> each(const Columns& columns, Member member) {
    std::vector<std::string> all;
    for (const auto& column : columns) all.emplace_back(column.*member);
    return all;
}

// The tables of a scene of one body.
class BodyColumns : public EnsembleColumns {
  public:
    explicit BodyColumns(const Scene& scene)
        : EnsembleColumns(each(body_columns, &BodyColumn::name), each(body_columns, &BodyColumn::block)),
          pivoted_(scene.pivot.has_value()),
          start_(ensemble_body(scene)) {}

    const char* row_noun() const override { return "body"; }
    void begin(EnsembleTable& table, std::size_t rows) const override { table.bodies.reserve(rows); }

    void append(EnsembleTable& table, const std::vector<double>& numbers, const EnsembleStream& stream) const override {
        EnsembleBody& body = table.bodies.emplace_back(start_);
        for (std::size_t i = 0; i < numbers.size(); ++i) put_[i](body, numbers[i]);
        if (const auto fault = fault_of(body, pivoted_)) {
            table.bodies.pop_back();
            stream.refuse(*fault);
        }
    }

  private:
    void on_selection(const std::vector<std::size_t>& selected, const std::string& file,
                      const std::string& place) override {
        for (const std::size_t i : selected) put_.push_back(body_columns[i].put);
        if (has_block(block_products) && !has_block(block_moments))
            throw InputError(file, place, "has products of inertia without moments",
                             "give ixx,iyy,izz beside ixy,ixz,iyz");
        if (pivoted_ && (has_block(block_p) || has_block(block_v)))
            throw InputError(
                file, place,
                fmt::format("has columns {} in a scene with a pivot", has_block(block_p) ? block_p : block_v),
                "leave them out: the pivot and the attitude say where the centre of mass is");
        // moments without products: about the body's own axes
        if (has_block(block_moments)) start_.inertia_B = {};
    }

    bool pivoted_;
    EnsembleBody start_;  // the scene's own body, without its tensor where the table has moments
    std::vector<void (*)(EnsembleBody&, double)> put_;  // by column
};

// The tables of a scene of several bodies.
class MechanismColumns : public EnsembleColumns {
  public:
    explicit MechanismColumns(const Scene& scene) : MechanismColumns(scene, mechanism_columns(scene)) {}

    const char* row_noun() const override { return "start"; }

    std::optional<BodyFault> fault_of_id(std::string_view id) const override {
        if (!EnsembleColumns::fault_of_id(id)) return {};
        return BodyFault{"id", "holds more than 200 bytes, quotes or control characters", "give short plain text"};
    }
    void begin(EnsembleTable& table, std::size_t rows) const override {
        table.mechanisms.columns = columns_;
        table.mechanisms.numbers.reserve(rows * columns_.size());
    }
    void append(EnsembleTable& table, const std::vector<double>& numbers, const EnsembleStream& stream) const override {
        validate(scene_with(scene_, columns_, numbers), stream.where());
        table.mechanisms.numbers.insert(table.mechanisms.numbers.end(), numbers.begin(), numbers.end());
    }

  private:
    MechanismColumns(const Scene& scene, std::vector<MechanismColumn> known)
        : EnsembleColumns(each(known, &MechanismColumn::name), each(known, &MechanismColumn::block)),
          scene_(scene),
          known_(std::move(known)) {}

    void on_selection(const std::vector<std::size_t>& selected, const std::string&, const std::string&) override {
        for (const std::size_t i : selected) columns_.push_back(known_[i]);
    }

    const Scene& scene_;
    std::vector<MechanismColumn> known_, columns_;  // all, and the table's
};

}  // namespace

EnsembleColumns::EnsembleColumns(std::vector<std::string> names, std::vector<std::string> blocks)
    : names_(std::move(names)), blocks_(std::move(blocks)) {
    names_.emplace_back("id");
}

void EnsembleColumns::select(const std::vector<std::size_t>& places, const std::string& file,
                             const std::string& place) {
    std::vector<bool> is_selected(names_.size());
    for (const std::size_t i : places) {
        is_selected[i] = true;
        if (i < blocks_.size()) selected_.push_back(i), selected_blocks_.insert(blocks_[i]);
    }
    has_ids_ = is_selected.back();
    if (selected_.empty())
        throw InputError(file, place, "has no column but id", "give at least one, such as " + example());
    for (std::size_t i = 0; i < blocks_.size(); ++i)
        if (!is_selected[i] && has_block(blocks_[i]))
            throw InputError(file, place, fmt::format("column {} is missing", names_[i]),
                             fmt::format("give all of {}, or none", blocks_[i]));
    on_selection(selected_, file, place);
}

std::optional<BodyFault> EnsembleColumns::fault_of_id(std::string_view id) const {
    if (id.size() > longest_id) return BodyFault{"id", "has more than 200 bytes", "give shorter ids"};
    if (first_invalid_utf8(id) != std::string_view::npos) return BodyFault{"id", "is not UTF-8", "give UTF-8"};
    if (one_line(id, id.size()) != id || id.find('"') != id.npos)
        return BodyFault{"id", one_line(id, 60) + " holds quotes or control characters",
                         "give plain text without commas"};
    return {};
}

std::unique_ptr<EnsembleColumns> ensemble_columns(const Scene& scene) {
    if (is_mechanism(scene)) return std::make_unique<MechanismColumns>(scene);
    return std::make_unique<BodyColumns>(scene);
}

}  // namespace polhode
