// The rows that an ensemble writes, as CSV or in NumPy's binary format.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "integrators/own/mechanism_ensemble.h"
#include "motion/ensemble_stream.h"

namespace polhode {

/// Some rows of a table and what became of them.
struct SolvedPiece {
    EnsembleTable table;                       ///< the rows
    std::size_t first_row = 1;                 ///< the number of the first among all rows
    std::vector<std::vector<EnsembleRow>> at;  ///< of one body: at each time, the last one being the end, by row
    std::vector<MechanismRow> mechanisms;      ///< of several bodies: by row
    std::string text;                          ///< as it is written
    double solving = 0, formatting = 0;        ///< s that this took

    /// Whether there is no row.
    bool is_empty() const { return table.rows() == 0 && table.refused.empty(); }
};

/// One line of CSV, or one record of an .npy file: a body at one time, or why there is none.
struct EnsembleRecord {
    std::size_t row;             ///< its number in the table
    const std::string* id;       ///< null where the table has none, and of a row that was refused
    Status status;               ///< of a body's run until then, or of a row that has come to its end early
    const Sample* sample;        ///< the motion; null where there is none
    std::string_view body;       ///< of several bodies its name
    const std::string& message;  ///< why status is not ok
};

/// How a record is written.
class EnsembleFormat {
  public:
    virtual ~EnsembleFormat() = default;
    /// The text in front of `bytes` bytes of records: of the same length for any number of them.
    virtual std::string header(std::uint64_t bytes) const = 0;
    /// Whether the header depends on the number of records.
    virtual bool counts_records() const = 0;
    /// Appends a record.
    virtual void append(std::string& text, const EnsembleRecord& record) const = 0;
};

/// The format of `path`: NumPy's where it ends in .npy, else CSV. Throws InputError where ids of the table would have
/// no width in NumPy's format; it calls the table `file`.
std::unique_ptr<EnsembleFormat> format_of(const std::string& path, const Scene& scene, const EnsembleStream& table,
                                          const std::string& file);

/// The rows of a piece in their order, each at all times, and at each all bodies of the scene. A mechanism whose run
/// ended early has one record more, which reports why.
std::string rows_of(const SolvedPiece& piece, const Scene& scene, const EnsembleFormat& format);

}  // namespace polhode
