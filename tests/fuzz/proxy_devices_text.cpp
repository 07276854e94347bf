// What a gateway's tuples may hold: the device list, device keys, types and input statuses. What
// parses prints back to the same text, and a manager fed with it stays balanced.
#include <algorithm>
#include <cstdint>
#include <string>

#include "core/tuples/device_keys.hpp"
#include "proxy/classes/tuple_key.hpp"
#include "proxy/manager.hpp"
#include "require.hpp"

namespace {

using namespace rubicon;

proxy::class_table classes() {
  proxy::proxy_class any;
  any.name = "any";
  any.types = {{0, 0x7fffffff}};
  return proxy::class_table({any});
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const byte_view octets(data, size);
  const std::string text(tuple_text(octets));
  if (const auto list = parse_device_list(text))
    require(device_list_text(*list) == text);
  if (const auto status = parse_input_status(text))
    require(to_string(*status) == text);
  if (const auto key = parse_device_key(text))
    require(proxy::same_key(to_string(*key), text));
  if (const auto type = parse_device_type(octets))
    require(device_type_octets(*type) == to_bytes(octets));

  // The text as the key, what follows its NUL as the value, for a mote that is there and is not.
  proxy::manager manager(classes(), 64);
  static_cast<void>(manager.on_devices(island_id{5}, "{1,7}", instant{}));
  const auto value = octets.subspan(std::min(size, text.size() + 1));
  static_cast<void>(manager.on_gateway_tuple(island_id{5}, text, value, instant{}));
  static_cast<void>(manager.on_devices(island_id{5}, text, instant{}));
  const auto& counters = manager.counters();
  require(manager.running() == counters.started - counters.stopped);

  require(proxy::key_part(text).find_first_of(".*") == std::string::npos);
  return 0;
}
