// For files of this room only: a trace as rows, branches indented, what is of no interest in one
// row.
#pragma once

#include <string>
#include <vector>

#include "explain/traces.hpp"
#include "report/print/text_layout.hpp"

namespace rubicon::explain {

struct tree_row {
  instant time;
  duration after{}; ///< since the row before on this branch
  bool is_first = false;
  std::string where; ///< with the branches drawn in front
  std::string what;
  report::look look = report::look::plain;
};

class tree {
public:
  explicit tree(const traces& all) : all_(all) {}

  /// A step and everything that came of it.
  void add(node_index root);

  /// Only the steps from the first cause to this one, which is left out.
  void add_path_to(node_index n);

  [[nodiscard]] const std::vector<tree_row>& rows() const { return rows_; }

private:
  /// What is shown together: a row and what follows it.
  struct block {
    node_index first = no_node;
    std::vector<node_index> members; ///< shown in one row
    std::vector<node_index> then;    ///< children of the row
    std::string where;
    std::string what;
    instant time;
    report::look look = report::look::plain;
  };

  void show(const block& x, instant before, const std::string& lead, const std::string& own_lead);
  [[nodiscard]] std::vector<block> blocks_of(const std::vector<node_index>& children) const;
  [[nodiscard]] block plain(node_index n) const;
  [[nodiscard]] block package_chain(node_index n) const;
  [[nodiscard]] block greeting(const std::vector<node_index>& hops) const;
  [[nodiscard]] block answer(node_index n) const;
  [[nodiscard]] block failed_attempt(node_index n, std::size_t number, std::size_t of) const;
  [[nodiscard]] block settings(const std::vector<node_index>& leaves) const;
  [[nodiscard]] bool leads_on(node_index n) const;
  [[nodiscard]] const node& at(node_index n) const { return all_.nodes[n]; }

  const traces& all_;
  std::vector<tree_row> rows_;
};

} // namespace rubicon::explain
