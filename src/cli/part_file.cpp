#include "cli/part_file.hpp"

#include <cerrno>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <system_error>

#include "control/octets.hpp"

namespace rubicon::cli {

std::string write_part_file(const std::string& path, const report::part_report& x, bool is_final) {
  const auto octets = control::octets_of(x);
  const auto next = path + ".new";
  std::ofstream out(next, std::ios::binary | std::ios::trunc);
  out.put(is_final ? '1' : '0');
  out.write(reinterpret_cast<const char*>(octets.data()),
            static_cast<std::streamsize>(octets.size()));
  out.close();
  if (!out || std::rename(next.c_str(), path.c_str()) != 0)
    return path + " cannot be written: " + std::generic_category().message(errno);
  return {};
}

std::optional<part_file> read_part_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  const bytes content{std::istreambuf_iterator<char>(in), {}};
  if (!in || content.empty())
    return std::nullopt;
  auto told = control::part_report_of(byte_view(content).subspan(1));
  if (!told)
    return std::nullopt;
  return part_file{*std::move(told), content.front() == '1'};
}

} // namespace rubicon::cli
