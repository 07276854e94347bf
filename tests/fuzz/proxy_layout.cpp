// A message of any length against a class of any layout: no crash, all fields or none, and numbers
// in plain decimal. Also any text written to an input: one outcome, or one write, or nothing.
#include <cstdint>
#include <string>

#include "core/codec.hpp"
#include "proxy/classes/layout.hpp"
#include "proxy/proxy.hpp"
#include "require.hpp"

namespace {

using namespace rubicon;

/// A class whose layout the input decides; not-a-number and infinities are no scale.
proxy::proxy_class read_class(byte_reader& in) {
  proxy::proxy_class what;
  const auto fields = in.octet() % 4;
  for (int i = 0; i < fields; ++i) {
    proxy::field x;
    x.name = "field" + std::to_string(i);
    x.channel = in.octet() % 2;
    x.offset = in.octet() % 16;
    x.layout = static_cast<proxy::encoding>(in.octet() % 6);
    x.decimals = in.octet() % 7;
    x.scale = in.big<std::int16_t>() / 100.0;
    x.add = in.big<std::int16_t>();
    if (in.octet() % 2 == 1)
      x.words = {{0, "off"}, {1, "on"}};
    what.fields.push_back(std::move(x));
  }
  what.inputs = {{"switch", 2, {{"on", {1}}, {"off", {0}}}}};
  return what;
}

bool is_readable(const std::string& text) {
  if (text == "on" || text == "off")
    return true;
  return !text.empty() && text.find_first_not_of("-0123456789.") == std::string::npos &&
         text != "-0";
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  byte_reader in(byte_view(data, size));
  const auto what = read_class(in);
  const auto payload = in.rest();
  std::size_t expected = 0;
  for (const auto& field : what.fields)
    expected += field.channel == 0 ? 1 : 0;
  const auto readings = proxy::decode(what, 0, payload);
  if (readings) {
    require(readings->size() == expected);
    for (const auto& x : *readings)
      require(is_readable(x.text));
  }

  proxy::proxy face(what, {{island_id{5}, mote_id{7}}, "kitchen", "lamp"});
  static_cast<void>(face.start(instant{}));
  const auto published = face.on_output(0, payload, instant{});
  require(published.size() == (readings ? expected : 0));
  const auto outputs = face.on_input("switch", tuple_text(payload), instant{});
  require(outputs.size() == face.counters().requested);
  static_cast<void>(face.on_input_status(2, tuple_text(payload), instant{}));
  return 0;
}
