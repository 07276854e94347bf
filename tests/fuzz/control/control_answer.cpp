// An answer of a host: its kind, then what it says. A report that is read can be counted up and
// told, whatever is in it.
#include "control/octets.hpp"
#include "report/report.hpp"

#include "fuzz/require.hpp"

using namespace rubicon;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0)
    return 0;
  const byte_view content(data + 1, size - 1);
  const auto found = control::answer_of(data[0], content);
  if (!found)
    return 0;
  require(found->index() == data[0]);
  require(control::octets_of(*found) == to_bytes(content));
  if (const auto* news = std::get_if<deploy::news>(&*found))
    for (const auto& life : news->lives)
      static_cast<void>(report::to_json(life.newest.report));
  return 0;
}
