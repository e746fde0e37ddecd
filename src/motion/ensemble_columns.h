// The columns of an ensemble's table, of one body or of several, whatever its format.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "motion/ensemble_table.h"

namespace polhode {

class EnsembleStream;

/// The columns that the tables of a scene may have, those that one table has, and how its rows are stored.
class EnsembleColumns {
  public:
    virtual ~EnsembleColumns() = default;

    /// The names of all columns, the last one being "id".
    const std::vector<std::string>& names() const { return names_; }
    /// A block that a table may have, as an example for messages.
    const std::string& example() const { return blocks_.front(); }
    /// What a row describes, in messages: "body" or "start".
    virtual const char* row_noun() const = 0;

    /// Selects the columns of a table, by their places in names() and in the table's order. Throws InputError, `place`
    /// being that of the columns' names: blocks that are not whole, no column but id, columns that exclude each other.
    void select(const std::vector<std::size_t>& places, const std::string& file, const std::string& place);
    /// How many numbers a row has.
    std::size_t size() const { return selected_.size(); }
    bool has_ids() const { return has_ids_; }

    /// What is wrong with an id, or nothing: more than 200 bytes, no UTF-8, quotes or control characters.
    virtual std::optional<BodyFault> fault_of_id(std::string_view id) const;
    /// Prepares a table without rows for about `rows` of them.
    virtual void begin(EnsembleTable& table, std::size_t rows) const = 0;
    /// Appends a row with a number for each selected column. Throws InputError, which names the row at hand of
    /// `stream`, where it breaks a rule of scenes; the table is as before then.
    virtual void append(EnsembleTable& table, const std::vector<double>& numbers,
                        const EnsembleStream& stream) const = 0;

  protected:
    /// Of columns by their names, and by the names of the columns that a table has together with each.
    EnsembleColumns(std::vector<std::string> names, std::vector<std::string> blocks);
    /// Called once with the selected columns, by their places. Throws InputError.
    virtual void on_selection(const std::vector<std::size_t>& selected, const std::string& file,
                              const std::string& place) = 0;
    bool has_block(const std::string& block) const { return selected_blocks_.contains(block); }

  private:
    std::vector<std::string> names_, blocks_;  // the last name is "id", which has no block
    std::vector<std::size_t> selected_;        // in the table's order, without id
    std::set<std::string> selected_blocks_;
    bool has_ids_ = false;
};

/// The columns of a scene's tables. The scene outlives what is returned.
std::unique_ptr<EnsembleColumns> ensemble_columns(const Scene& scene);

}  // namespace polhode
