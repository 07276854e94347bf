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

  /// `── Event log ─────────` over the whole width, after a blank line.
  void heading(std::string_view title);

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
};

} // namespace rubicon::report
