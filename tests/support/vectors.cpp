#include "support/vectors.hpp"

#include <fstream>
#include <stdexcept>

namespace rubicon::test {

namespace {

std::ifstream open_vector_file(std::string_view file) {
  const auto path = std::string(RUBICON_GOLDEN_DIR "/").append(file);
  std::ifstream stream(path);
  if (!stream)
    throw std::runtime_error("cannot read " + path);
  return stream;
}

} // namespace

std::vector<vector_case> read_cases(std::string_view file) {
  auto stream = open_vector_file(file);
  std::vector<vector_case> cases;
  vector_case current;
  const auto finish = [&] {
    if (!current.empty())
      cases.push_back(std::move(current));
    current.clear();
  };
  for (std::string line; std::getline(stream, line);) {
    if (line.empty()) {
      finish();
    } else if (line[0] != '#') {
      const auto colon = line.find(": ");
      if (colon != std::string::npos)
        current.emplace(line.substr(0, colon), line.substr(colon + 2));
    }
  }
  finish();
  return cases;
}

bytes read_hex_file(std::string_view file) {
  auto stream = open_vector_file(file);
  std::string digits;
  for (std::string line; std::getline(stream, line);)
    digits += line.substr(0, line.find('#'));
  auto octets = from_hex(digits);
  if (!octets)
    throw std::runtime_error("not hexadecimal: " + std::string(file));
  return *octets;
}

} // namespace rubicon::test
