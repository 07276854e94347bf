// What is to be seen of a run, as tables that spreadsheets, pandas and R read (docs/data.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <string>
#include <string_view>

#include "config/plan/ecology.hpp"
#include "report/history.hpp"
#include "report/report.hpp"

namespace rubicon::report {

/// A field of a line, quoted where RFC 4180 section 2 wants it.
[[nodiscard]] std::string csv_field(std::string_view x);

/// One line, with its newline.
[[nodiscard]] std::string csv_line(std::initializer_list<std::string_view> fields);

/// The tables of a run. Each begins with its header; rows are added as time goes on.
class csv_tables {
public:
  enum class kind : std::uint8_t { energy, links, losses, places, tuples, events };
  static constexpr std::size_t kinds = 6;

  explicit csv_tables(const config::ecology_description& names);

  [[nodiscard]] static std::string_view name(kind x); ///< of the file, without `.csv`
  [[nodiscard]] static std::string header(kind x);

  [[nodiscard]] std::string energy(const run_sample& x) const;
  [[nodiscard]] std::string links(const run_sample& x) const;
  [[nodiscard]] std::string losses(const run_sample& x) const;
  [[nodiscard]] static std::string places(const run_sample& x);
  [[nodiscard]] static std::string row(const tuple_write& x);
  [[nodiscard]] static std::string row(const logged_event& x);

private:
  struct island_names {
    std::string island;
    mote_id sink;
    std::map<mote_id, std::string> motes;
  };

  [[nodiscard]] const std::string& island_of(island_id x) const;
  [[nodiscard]] std::string mote_of(island_id island, mote_id x) const;

  std::map<island_id, island_names> names_;
};

} // namespace rubicon::report
