// The traces that a TOML file names.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <utility>

#include "config/file_readers.hpp"
#include "config/toml/table_reader.hpp"
#include "device/trace_file.hpp"

namespace rubicon::config {

/// Reads each column once, however many motes replay it.
class trace_files {
public:
  /// @param files outlives this
  explicit trace_files(const named_files& files) : files_(files) {}

  /// The column of the file that `key` of `in` names; nullptr: complained, of the file itself once.
  [[nodiscard]] std::shared_ptr<const device::dated_trace> read(const table_reader& in,
                                                                std::string_view key,
                                                                const std::string& name,
                                                                const device::trace_format& format);

private:
  const named_files& files_;
  std::map<std::pair<std::string, device::trace_format>, std::shared_ptr<const device::dated_trace>>
      tables_; ///< nullptr: has mistakes, which are reported
};

} // namespace rubicon::config
