// Whatever the text, reading it ends with a trace that noise can be made of or with one plain,
// placed message.
#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>
#include <variant>

#include "file_problem.hpp"
#include "radio/medium/tossim_files.hpp"

using namespace rubicon;
using namespace rubicon::radio;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view input(reinterpret_cast<const char*>(data), size);
  const auto x = read_noise_trace(input);
  if (const auto* problem = std::get_if<file_problem>(&x)) {
    check_problem(*problem, input);
    return 0;
  }
  const auto& trace = std::get<std::shared_ptr<const noise_trace>>(x);
  const auto& readings = trace->readings();
  assert(readings.size() >= noise_trace::readings_min && readings.size() <= size);
  noise_source source(trace, random_stream(size));
  for (int ms = 0; ms < 300; ++ms)
    assert(std::count(readings.begin(), readings.end(), source.at(instant{} + ms * 1ms)) > 0);
  return 0;
}
