// The page a report is written on: headings, flowing text and tables, all within one width.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "report/print/report_text.hpp"
#include "report/print/text_layout.hpp"

namespace rubicon::report {

class report_page {
public:
  explicit report_page(const text_options& options);

  /// `── Event log ───────── what happened ──` over the whole width, after a blank line.
  /// @param purpose what the part is for; on a line of its own if the width is too small
  void heading(std::string_view title, std::string_view purpose);

  /// `name (label)`
  [[nodiscard]] std::string named(config::label_table::kind what, const std::string& name) const {
    return labels_.with_name(what, name);
  }
  [[nodiscard]] std::string mote(const std::string& island, const std::string& name) const {
    return named(config::label_table::kind::mote, island + '/' + name);
  }
  /// The label of its class, or that of the mote whose name its prefix is.
  [[nodiscard]] std::string proxy(const proxy_report& x) const;
  /// Who is in the event log.
  [[nodiscard]] std::string anybody(const std::string& who) const;

  void line(std::string_view text, look how = look::plain);

  /// The parts one after the other with a dot between, on as many lines as they need. Empty parts
  /// are skipped.
  void flow(const std::vector<std::string>& parts, look how = look::plain);

  void add(const table& x);

  /// How many of so many rows are shown, where not more than `at_most` are unless all are wanted.
  [[nodiscard]] std::size_t shown(std::size_t rows, std::size_t at_most) const;
  [[nodiscard]] bool is_full() const { return full_; }

  /// Below a table of which only so many rows are shown.
  static void add_rest(table& rows, std::size_t all, std::size_t shown);

  [[nodiscard]] std::string finish() { return std::move(text_); }

private:
  std::string text_;
  std::size_t width_;
  std::size_t room_; ///< of a line; more than the width in a file, where nothing is cut
  bool colour_;
  bool full_;
  config::label_table labels_;
};

} // namespace rubicon::report
