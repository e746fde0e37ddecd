// The rows that an ensemble writes, as CSV or in NumPy's binary format.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "integrators/own/ensemble.h"
#include "motion/ensemble_stream.h"
#include "motion/ensemble_table.h"

namespace polhode {

/// Some rows of a table and what became of them.
struct SolvedPiece {
    EnsembleTable table;                       ///< the rows
    std::size_t first_row = 1;                 ///< the number of the first among all rows
    std::vector<std::vector<EnsembleRow>> at;  ///< at each time, the last one being the end: a row a body
    std::string text;                          ///< as it is written
    double solving = 0, formatting = 0;        ///< s that this took

    /// Whether there is no row.
    bool is_empty() const { return table.bodies.empty() && table.refused.empty(); }
    /// The number of each body's row among all rows.
    std::vector<std::size_t> numbers() const;
};

/// How a row is written.
class EnsembleFormat {
  public:
    virtual ~EnsembleFormat() = default;
    /// What stands in front of the rows, of so many: as long for any number of them.
    virtual std::string header(std::uint64_t rows) const = 0;
    /// Whether the header tells the number of rows.
    virtual bool counts_rows() const = 0;
    /// Appends a row; `id` is null of a row that was refused.
    virtual void append_row(std::string& text, std::size_t number, const std::string* id,
                            const EnsembleRow& row) const = 0;
};

/// The format of `path`: NumPy's where it ends in .npy, else CSV. Throws InputError where ids of the table would have
/// no width in NumPy's format; it calls the table `file`.
std::unique_ptr<EnsembleFormat> format_of(const std::string& path, const EnsembleStream& table,
                                          const std::string& file);

/// The rows of a piece in their order, each at all times.
std::string rows_of(const SolvedPiece& piece, const EnsembleFormat& format);

/// Appends a comma and the number, or only the comma where it is none.
void append_number(std::string& text, double value);

/// Appends a comma and the numbers of a body's motion: quaternion, angular velocity in world axes, place, velocity.
void append_numbers(std::string& text, const Sample& sample);

/// Appends a comma and the message in quotes, or only the comma where it is empty.
void append_message(std::string& text, const std::string& message);

}  // namespace polhode
