#include "control/octets.hpp"

#include <utility>
#include <vector>

#include <caf/binary_deserializer.hpp>
#include <caf/binary_serializer.hpp>

#include "control/inspect.hpp"

namespace rubicon::control {

namespace {

template <class T>
bytes saved(T x) { // inspectors take what they may change
  std::vector<char> out;
  caf::binary_serializer sink(nullptr, out);
  static_cast<void>(sink(x));
  return {out.begin(), out.end()};
}

template <class T>
result<T> loaded(byte_view octets) {
  caf::binary_deserializer source(nullptr, reinterpret_cast<const char*>(octets.data()),
                                  octets.size());
  T x;
  if (source(x))
    return errc::bad_value;
  return x;
}

} // namespace

bytes octets_of(const report::part_report& x) {
  return saved(x);
}

bytes octets_of(const deploy::bundle& x) {
  return saved(x);
}

result<report::part_report> part_report_of(byte_view octets) {
  return loaded<report::part_report>(octets);
}

result<deploy::bundle> bundle_of(byte_view octets) {
  return loaded<deploy::bundle>(octets);
}

} // namespace rubicon::control
