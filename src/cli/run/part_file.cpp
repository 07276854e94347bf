#include "cli/run/part_file.hpp"

#include <fstream>
#include <iterator>

#include "control/octets.hpp"
#include "io/files/replace_file.hpp"

namespace rubicon::cli {

std::string write_part_file(const std::string& path, const report::part_report& x, bool is_final) {
  const auto octets = control::octets_of(x);
  std::string content(1, is_final ? '1' : '0');
  content.append(octets.begin(), octets.end());
  return io::replace_file(path, content);
}

std::optional<part_file> read_part_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  const bytes content{std::istreambuf_iterator<char>(in), {}};
  if (!in || content.empty())
    return std::nullopt;
  auto newest = control::part_report_of(byte_view(content).subspan(1));
  if (!newest)
    return std::nullopt;
  return part_file{*std::move(newest), content.front() == '1'};
}

} // namespace rubicon::cli
