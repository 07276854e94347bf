// Whatever the text, reading it ends with a table in order or with one plain, placed message. The
// first octet chooses how the rest is to be read.
#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>
#include <variant>

#include "device/trace_file.hpp"
#include "device/transducer.hpp"
#include "file_problem.hpp"

using namespace rubicon;
using namespace rubicon::device;

namespace {

trace_format format_of(std::uint8_t choice) {
  trace_format format;
  format.value_column = "light";
  if ((choice & 1U) != 0)
    format.columns = {"date", "time", "epoch", "mote", "light"};
  if ((choice & 2U) != 0)
    format.date_column = "date";
  if ((choice & 4U) != 0)
    format.mote_column = "mote";
  if ((choice & 8U) != 0)
    format.start = parse_trace_time("2004-02-28 00:59:16");
  return format;
}

void check_series(const time_series& series, duration turn) {
  assert(!series.empty() && series.back().first <= turn);
  for (std::size_t i = 1; i < series.size(); ++i)
    assert(series[i - 1].first < series[i].first);
}

/// Replays it: a reading is within the values of the series.
void check_readings(const std::shared_ptr<const trace_table>& table, std::uint32_t mote,
                    bool straight) {
  random_stream rng(1);
  const auto& series = table->of_mote.at(mote);
  double least = series.front().second;
  double most = least;
  for (const auto& [at, value] : series) {
    least = std::min(least, value);
    most = std::max(most, value);
  }
  const transducer_config config{quantity::light, trace_model{table, mote, true, straight, 1, 0}};
  const auto slack = 1e-9 * (std::abs(least) + std::abs(most));
  for (int i = 0; i < 18; ++i) {
    const auto value = value_of(config, instant{table->turn / 16 * i}, rng);
    assert(value >= least - slack && value <= most + slack);
  }
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0)
    return 0;
  const std::string_view input(reinterpret_cast<const char*>(data) + 1, size - 1);
  const auto x = read_trace(input, format_of(data[0]));
  if (const auto* problem = std::get_if<trace_problem>(&x)) {
    check_problem({problem->line, problem->message}, input);
    return 0;
  }
  const auto& table = std::get<0>(x);
  assert(!table->of_mote.empty());
  for (const auto& [mote, series] : table->of_mote) {
    check_series(series, table->turn);
    check_readings(table, mote, (data[0] & 16U) != 0);
  }
  return 0;
}
