// What `run --record` has written, read and put together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <fstream>
#include <optional>
#include <string>
#include <variant>

#include "explain/record.hpp"
#include "explain/traces.hpp"

namespace rubicon::cli {

/// Reads a record part by part, also one that is still written: then on from where it was.
class record_reader {
public:
  static constexpr std::size_t part_octets = 1 << 18;

  /// @param keeps_view as of explain::following
  explicit record_reader(std::string path, bool keeps_view = true);

  /// Takes some of what there is, at most part_octets. @returns whether there was anything
  [[nodiscard]] bool read_part();

  /// The record is complete: half a line at its end is left out.
  /// @pre read_part() has found nothing more
  void finish();

  /// What is wrong, `run.rec:12: the line is no JSON`; nothing follows then. Empty: all is well.
  [[nodiscard]] const std::string& problem() const { return problem_; }

  [[nodiscard]] std::uint64_t octets() const { return octets_; } ///< that were read

  /// @pre has_begun()
  [[nodiscard]] const explain::traces& so_far() const { return all_->so_far(); }
  [[nodiscard]] bool has_begun() const { return all_.has_value(); } ///< its header is known

  /// All, after finish(). @pre has_begun()
  [[nodiscard]] explain::traces result() { return all_->finish(cut_off_); }

private:
  void take_lines();
  void take_records();
  void refuse(const explain::bad_line& x);

  std::string path_;
  bool keeps_view_;
  std::ifstream file_;
  std::string rest_; ///< of which no newline has come yet
  std::string part_;
  std::uint64_t octets_ = 0;
  explain::decoder lines_;
  bool cut_off_ = false;
  std::optional<explain::following> all_;
  std::string problem_;
};

/// @returns the traces, or what is wrong: `run.rec:12: the line is no JSON`
[[nodiscard]] std::variant<explain::traces, std::string> read_record(const std::string& path);

} // namespace rubicon::cli
