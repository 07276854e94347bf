// Lines of a program that steers a run: any line has an answer that is JSON, one for each request,
// and what was done is done again, the same, by the lines that record it.
#include "steering/session.hpp"

#include <cstdint>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "fuzz/require.hpp"

using namespace rubicon;
using nlohmann::json;

namespace {

/// A run in which everything succeeds that can be read.
steering::session new_session() {
  return {{.name = "home",
           .seed = 7,
           .length = 60s,
           .peers = {"pc"},
           .motes = {{mote_address{island_id{1}, mote_id{2}}, "kitchen/fan"}}},
          {.run_until = [](instant until) { return until; },
           .tuple = [](const steering::get_request& x) { return std::optional(x.key); },
           .set_tuple = [](const steering::set_request&) { return std::string(); },
           .fault = [](const std::string&, instant) { return std::string(); },
           .send = [](const steering::send_request&, std::uint32_t) { return std::string(); },
           .table = [](const std::string&, const std::string& at) { return at + '\n'; },
           .look = [] { return report::run_sample(); },
           .report = [] { return std::string("{}"); },
           .finish = [] { return std::string("{}"); }}};
}

bool is_answer(const json& x) {
  return x.is_object() && x.contains("ok") && x["ok"].is_boolean() &&
         x.contains("why") == !x["ok"].get<bool>();
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view line(reinterpret_cast<const char*>(data), size);
  auto session = new_session();
  const auto read = steering::read_line(line);
  const auto answer = json::parse(session.on_line(line)); // aborts if it is none
  if (const auto* all = std::get_if<steering::request_line>(&read); all && all->is_batch) {
    require(answer.is_array() && answer.size() == all->requests.size());
    for (const auto& each : answer)
      require(is_answer(each));
  } else {
    require(is_answer(answer));
  }

  const auto lines = session.lines();
  auto again = new_session();
  for (std::size_t begin = 0; begin < lines.size();) {
    const auto end = lines.find('\n', begin);
    require(json::parse(again.on_line(lines.substr(begin, end - begin)))["ok"] == true);
    begin = end + 1;
  }
  require(again.lines() == lines);
  const auto tables = session.tables();
  require(tables.empty() == lines.empty());
  for (const char c : tables) // a comment of TOML
    require(c == '\n' || (c >= ' ' && c != 0x7f));
  return 0;
}
