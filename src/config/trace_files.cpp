#include "config/trace_files.hpp"

#include <filesystem>
#include <variant>

namespace rubicon::config {

std::shared_ptr<const device::dated_trace> trace_files::read(const table_reader& in,
                                                             std::string_view key,
                                                             const std::string& name,
                                                             const device::trace_format& format) {
  const auto path = (std::filesystem::path(files_.toml).parent_path() / name).string();
  if (const auto known = tables_.find({path, format}); known != tables_.end())
    return known->second;
  const auto file = files_.read(path, device::trace_octets_max);
  if (!file.text) {
    in.problems().add(in.at(key), in_quotes(path) + ' ' + file.reason);
    return nullptr;
  }
  auto found = device::read_trace(*file.text, format);
  std::shared_ptr<const device::dated_trace> table;
  if (auto* wrong = std::get_if<device::trace_problem>(&found))
    in.problems().add(
        problem{path, static_cast<unsigned>(wrong->line), 0, std::move(wrong->message)});
  else
    table = std::get<0>(std::move(found));
  tables_.emplace(std::pair(path, format), table);
  return table;
}

} // namespace rubicon::config
