#include "actors/part_octets.hpp"

#include <utility>
#include <vector>

#include <caf/binary_deserializer.hpp>
#include <caf/binary_serializer.hpp>

#include "actors/inspect.hpp"

namespace rubicon {

bytes octets_of(const report::part_report& x) {
  std::vector<char> out;
  caf::binary_serializer sink(nullptr, out);
  auto copy = x; // inspectors take what they may change
  static_cast<void>(sink(copy));
  return {out.begin(), out.end()};
}

result<report::part_report> part_report_of(byte_view octets) {
  caf::binary_deserializer source(nullptr, reinterpret_cast<const char*>(octets.data()),
                                  octets.size());
  report::part_report x;
  if (source(x))
    return errc::bad_value;
  return x;
}

} // namespace rubicon
