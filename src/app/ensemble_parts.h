// An ensemble in parts: rows of one table solved apart, by several processes or machines, and put together again.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "scene/scene.h"

namespace polhode {

/// Part `part` of `parts`, counted from 1.
struct Shard {
    std::size_t part = 1, parts = 1;
};

/// Reads "I/N", 1 <= I <= N <= 10^6. Throws UsageError.
Shard parse_shard(const std::string& text);

/// The rows of a part, of so many in all: from the first on, without the last, both counted from 0. Parts follow each
/// other, and none has more than one row more than another.
std::pair<std::size_t, std::size_t> rows_of_shard(std::size_t rows, const Shard& shard);

/// Where a part of `output` goes, beside it: "out.part-0003-of-0200.npy" of "out.npy".
std::string part_path(const std::string& output, const Shard& shard);

/// What tells one table from another.
struct TableIdentity {
    std::size_t rows = 0;
    std::uint64_t bytes = 0;
    std::string hash;  ///< content_hash() of the file, or of what identity_of() reads of it
};

/// Looks a table through, once for its content and once for its rows: a CSV file whole, and of an .npy file of more
/// than 64 MiB a thousand blocks, so that two of one length that differ in few rows alone may pass for one. Throws
/// InputError.
TableIdentity identity_of(const std::string& path, const Scene& scene);

/// What stands beside a part's file: which part of what it is.
struct EnsemblePart {
    Shard shard;
    std::string output;       ///< the name of the whole, without a folder
    TableIdentity table;      ///< what it is a part of
    std::string scene;        ///< hash of the scene as it was solved
    std::string program;      ///< the program's key: what may give other bits
    std::string options;      ///< those that may change a row
    std::size_t rows = 0;     ///< of the table, in this part
    std::size_t ok = 0;       ///< rows whose run ended well
    std::size_t refused = 0;  ///< rows with a fault
    std::uint64_t bytes = 0;  ///< of the part's file behind its header
    std::string hash;         ///< content_hash() of them
};

/// As JSON.
std::string write_part(const EnsemblePart& part);

/// Reads what write_part() wrote. Throws InputError.
EnsemblePart parse_part(const std::string& text, const std::string& file);

/// Whether a folder holds parts of ensembles.
bool has_ensemble_parts(const std::string& dir);

/// What became of parts that were put together.
struct MergedEnsemble {
    std::string output;       ///< the file that was written
    std::size_t parts = 0;    ///< of how many parts
    std::size_t rows = 0;     ///< of the table
    std::size_t ok = 0;       ///< rows whose run ended well
    std::size_t refused = 0;  ///< rows with a fault
    /// Whether all rows ended well: what decides on the exit code of the whole.
    bool all_ok() const { return refused == 0 && ok == rows; }
};

/// Puts the parts in these folders together as `output` (in it, where it is a folder): the same bytes as one run over
/// the whole table. Where the folders hold parts of several ensembles, those of the one that is called as `output` are
/// taken. A part may be there several times, with the same content. Nothing else is changed, so that it may be done
/// again. Throws InputError where a part is missing, of something else or damaged, and std::runtime_error where
/// `output` cannot be written; it is not there then, or as it was.
MergedEnsemble merge_ensemble_parts(const std::vector<std::string>& dirs, const std::string& output);

}  // namespace polhode
