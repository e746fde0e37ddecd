#include "motion/ensemble_stream.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "motion/ensemble_columns.h"
#include "motion/ensemble_npy.h"
#include "text/csv_lines.h"
#include "text/decimal.h"
#include "text/input_file.h"
#include "text/message.h"

namespace polhode {
namespace {

// A CSV file, line by line.
class CsvEnsemble : public EnsembleStream {
  public:
    CsvEnsemble(std::string_view text, std::string file, const Scene& scene)
        : file_(std::move(file)), lines_(text, file_), pivoted_(scene.pivot.has_value()) {
        header(scene);
    }
    CsvEnsemble(std::unique_ptr<InputFile> input, std::string file, const Scene& scene)
        : file_(std::move(file)),
          input_(std::move(input)),
          lines_([this](char* bytes, std::size_t count) { return input_->read(bytes, count); }, file_),
          pivoted_(scene.pivot.has_value()) {
        header(scene);
    }

  protected:
    bool advance() override { return lines_.next(); }

    std::size_t advance_by(std::size_t rows) override {
        std::size_t passed = 0;
        while (passed < rows && lines_.next()) ++passed;
        return passed;
    }

    void read_row(EnsembleTable& piece) const override {
        const auto& cells = lines_.cells();
        if (cells.size() != columns_.size())
            fail(here(), fmt::format("has {} cells under {} columns", cells.size(), columns_.size()),
                 "give one cell per column");
        EnsembleBody& b = piece.bodies.emplace_back(start_);
        for (std::size_t i = 0; i < cells.size(); ++i) {
            if (columns_[i]->put == nullptr) {
                if (const auto fault = fault_of_id(cells[i])) fail(at(i), fault->fault, fault->remedy);
                piece.ids.emplace_back(cells[i]);
                continue;
            }
            const std::optional<double> value = parse_decimal(cells[i]);
            if (!value)
                fail(at(i), cells[i].empty() ? "is empty" : one_line(cells[i], 60) + " is not a number",
                     "give a decimal number such as -1.5e-3");
            if (!std::isfinite(*value)) fail(at(i), one_line(cells[i], 60) + " is not finite", "give a finite number");
            columns_[i]->put(b, *value);
        }
        if (const auto fault = fault_of(b, pivoted_))
            fail(fmt::format("{}, {}", here(), place_of(*fault)), fault->fault, fault->remedy);
    }

    std::size_t rows_left() const override { return lines_.rows_left(); }
    const std::string& file() const override { return file_; }

  private:
    [[noreturn]] void fail(const std::string& place, const std::string& fault, const std::string& remedy) const {
        throw InputError(file_, place, fault, remedy);
    }
    std::string here() const { return fmt::format("line {}", lines_.number()); }
    std::string at(std::size_t column) const {
        return fmt::format("line {}, column {}", lines_.number(), columns_[column]->name);
    }

    void header(const Scene& scene) {
        if (!lines_.next())
            fail("", "is empty", "give a header line such as qw,qx,qy,qz,wx,wy,wz and one line per body");
        std::vector<std::string> names;
        for (const EnsembleColumn& known : ensemble_columns()) names.emplace_back(known.name);
        for (const std::size_t place : lines_.header(names)) columns_.push_back(&ensemble_columns()[place]);
        has_ids_ = std::ranges::any_of(columns_, [](const EnsembleColumn* column) { return column->put == nullptr; });
        start_ = start_under(columns_, scene, file_, here());
    }

    const std::string file_;
    std::unique_ptr<InputFile> input_;
    CsvLines lines_;
    bool pivoted_;
    EnsembleBody start_;
    std::vector<const EnsembleColumn*> columns_;  // in the file's order
};

}  // namespace

bool EnsembleStream::next(EnsembleTable& piece, std::size_t most, BadRows bad) {
    piece.bodies.clear(), piece.ids.clear(), piece.refused.clear();
    std::size_t rows = 0;
    for (; rows < most && advance(); ++rows) {
        if (rows == 0) {
            const std::size_t expected = std::min(most, rows_left());
            piece.bodies.reserve(expected);
            if (has_ids_) piece.ids.reserve(expected);
        }
        ++rows_passed_;
        const std::size_t bodies = piece.bodies.size(), ids = piece.ids.size();
        try {
            read_row(piece);
        } catch (const InputError& fault) {
            if (bad == BadRows::refuse_all) throw;
            piece.bodies.resize(bodies), piece.ids.resize(ids);
            piece.refused.push_back({rows_passed_, fault.what()});
            if (first_refusal_.empty()) first_refusal_ = fault.what();
        }
    }
    bodies_ += piece.bodies.size();
    return rows > 0;
}

std::size_t EnsembleStream::skip(std::size_t rows) {
    const std::size_t passed = advance_by(rows);
    rows_passed_ += passed;
    return passed;
}

void EnsembleStream::require_bodies() const {
    if (bodies_ > 0) return;
    if (first_refusal_.empty()) throw InputError(file(), "", "has a header but no rows", "give one line per body");
    throw InputError(file(), "", "has no valid row", "first error: " + first_refusal_);
}

std::unique_ptr<EnsembleStream> open_ensemble(const std::string& path, const Scene& scene) {
    if (path.ends_with(".npy")) return open_npy_ensemble(path, scene);
    auto input = std::make_unique<InputFile>(path, path, "a readable CSV file", FileKinds::streamed);
    return std::make_unique<CsvEnsemble>(std::move(input), path, scene);
}

std::unique_ptr<EnsembleStream> ensemble_of_text(std::string_view text, const std::string& file, const Scene& scene) {
    return std::make_unique<CsvEnsemble>(text, file, scene);
}

}  // namespace polhode
