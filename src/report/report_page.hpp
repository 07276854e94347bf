// The page a report is written on: headings, flowing text and tables, all within one width.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "report/text_layout.hpp"

namespace rubicon::report {

class report_page {
public:
  /// No line is longer than `width` characters; less than 60 counts as 60.
  explicit report_page(std::size_t width, bool colour);

  /// `── Event log ─────────` over the whole width, after a blank line.
  void heading(std::string_view title);

  void line(std::string_view text, look how = look::plain);

  /// The parts one after the other with a dot between, on as many lines as they need. Empty parts
  /// are skipped.
  void flow(const std::vector<std::string>& parts, look how = look::plain);

  void add(const table& x);

  [[nodiscard]] std::string finish() { return std::move(text_); }

private:
  std::string text_;
  std::size_t width_;
  bool colour_;
};

} // namespace rubicon::report
