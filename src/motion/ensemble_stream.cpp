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
        : EnsembleStream(std::move(file), scene), lines_(text, file_) {
        read_header();
    }
    CsvEnsemble(std::unique_ptr<InputFile> input, std::string file, const Scene& scene)
        : EnsembleStream(std::move(file), scene),
          input_(std::move(input)),
          lines_([this](char* bytes, std::size_t count) { return input_->read(bytes, count); }, file_) {
        read_header();
    }

  protected:
    bool advance() override { return lines_.next(); }

    std::size_t advance_by(std::size_t rows) override {
        std::size_t passed = 0;
        while (passed < rows && lines_.next()) ++passed;
        return passed;
    }

    void read_cells() override {
        const auto& cells = lines_.cells();
        if (cells.size() != places_.size())
            fail(here(), fmt::format("has {} cells under {} columns", cells.size(), places_.size()),
                 "give one cell per column");
        const std::size_t id_place = columns().names().size() - 1;
        auto number = numbers_.begin();
        for (std::size_t i = 0; i < cells.size(); ++i) {
            if (places_[i] == id_place) {
                if (const auto fault = columns().fault_of_id(cells[i])) refuse(*fault);
                id_ = cells[i];
                continue;
            }
            const std::optional<double> value = parse_decimal(cells[i]);
            if (!value)
                refuse({name(i), cells[i].empty() ? "is empty" : one_line(cells[i], 60) + " is not a number",
                        "give a decimal number such as -1.5e-3"});
            if (!std::isfinite(*value))
                refuse({name(i), one_line(cells[i], 60) + " is not finite", "give a finite number"});
            *number++ = *value;
        }
    }

    std::size_t rows_left() const override { return lines_.rows_left(); }
    std::string here() const override { return fmt::format("line {}", lines_.number()); }

  private:
    const std::string& name(std::size_t cell) const { return columns().names()[places_[cell]]; }

    void read_header() {
        if (!lines_.next())
            fail("", "is empty",
                 fmt::format("give a header line such as {} and one line per {}", columns().example(),
                             columns().row_noun()));
        places_ = lines_.header(columns().names());
        select(places_, here());
    }

    std::unique_ptr<InputFile> input_;
    CsvLines lines_;
    std::vector<std::size_t> places_;  // index of each cell's column among all columns
};

}  // namespace

EnsembleStream::EnsembleStream(std::string file, const Scene& scene)
    : file_(std::move(file)), columns_(ensemble_columns(scene)) {}

void EnsembleStream::fail(const std::string& place, const std::string& fault, const std::string& remedy) const {
    throw InputError(file_, place, fault, remedy);
}

void EnsembleStream::refuse(const BodyFault& fault) const {
    const char* const noun = fault.columns.find(',') == std::string::npos ? "column" : "columns";
    fail(fmt::format("{}, {} {}", here(), noun, fault.columns), fault.fault, fault.remedy);
}

void EnsembleStream::select(const std::vector<std::size_t>& places, const std::string& place) {
    columns_->select(places, file_, place);
    numbers_.resize(columns_->size());
}

bool EnsembleStream::next(EnsembleTable& piece, std::size_t most, BadRows bad) {
    piece.bodies.clear(), piece.mechanisms.numbers.clear(), piece.ids.clear(), piece.refused.clear();
    std::size_t rows = 0;
    for (; rows < most && advance(); ++rows) {
        if (rows == 0) {
            const std::size_t expected = std::min(most, rows_left());
            columns_->begin(piece, expected);
            if (has_ids()) piece.ids.reserve(expected);
        }
        ++rows_passed_;
        try {
            read_cells();
            columns_->append(piece, numbers_, *this);
            if (has_ids()) piece.ids.emplace_back(id_);
        } catch (const InputError& fault) {
            if (bad == BadRows::refuse_all) throw;
            piece.refused.push_back({rows_passed_, fault.what()});
            if (first_refusal_.empty()) first_refusal_ = fault.what();
        }
    }
    rows_taken_ += piece.rows();
    return rows > 0;
}

EnsembleTable EnsembleStream::empty_table() const {
    EnsembleTable table;
    columns_->begin(table, 0);
    return table;
}

std::size_t EnsembleStream::skip(std::size_t rows) {
    const std::size_t passed = advance_by(rows);
    rows_passed_ += passed;
    return passed;
}

void EnsembleStream::require_rows() const {
    if (rows_taken_ > 0) return;
    const char* const noun = columns_->row_noun();
    if (first_refusal_.empty()) fail("", "has a header but no rows", fmt::format("give one line per {}", noun));
    fail("", "has no valid row", "first error: " + first_refusal_);
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
