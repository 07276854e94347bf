// Records of runs: no crash on any text, what is read is written back the same, and whatever is in
// it can be followed, printed and exported.
#include <cstdlib>

#include "explain/print/text.hpp"
#include "exports/mcap_file.hpp"
#include "exports/trace_events.hpp"

using namespace rubicon;
using namespace rubicon::explain;

namespace {

void check_round_trip(const recording& x) {
  auto text = encode(x.about);
  for (const auto& r : x.records)
    text += encode(r);
  const auto back = read(text);
  if (back.problem || back.content.about != x.about || back.content.records != x.records)
    std::abort();
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto x = read(std::string_view(reinterpret_cast<const char*>(data), size));
  if (x.problem)
    return 0;
  check_round_trip(x.content);
  const auto all = follow(x.content);
  static_cast<void>(list_text(all, {}, {}));
  for (std::size_t i = 0; i < all.messages.size(); ++i) {
    static_cast<void>(message_text(all, i, {}));
    static_cast<void>(message_json(all, i));
  }
  for (std::size_t i = 0; i < all.tuples.size(); ++i)
    static_cast<void>(tuple_text(all, i, {}));
  exports::write_trace_events(all, [](std::string_view) {});
  exports::write_mcap(all, [](std::string_view) {});
  return 0;
}
