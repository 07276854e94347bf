#include "cli/run/bundle_file.hpp"

#include <fstream>
#include <iterator>
#include <utility>

#include "control/octets.hpp"
#include "io/files/replace_file.hpp"

namespace rubicon::cli {

std::string write_bundle(const std::string& path, const deploy::bundle& x) {
  const auto octets = control::octets_of(x);
  return io::replace_file(path, {reinterpret_cast<const char*>(octets.data()), octets.size()});
}

std::optional<deploy::bundle> read_bundle(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  const bytes octets{std::istreambuf_iterator<char>(in), {}};
  auto found = control::bundle_of(octets);
  return found ? std::optional(*std::move(found)) : std::nullopt;
}

} // namespace rubicon::cli
