#include "mote/join/descriptor.hpp"

#include "core/codec.hpp"

namespace rubicon::mote {

namespace {

constexpr std::uint8_t tag_type = 1;
constexpr std::uint8_t tag_transducers = 2;
constexpr std::uint8_t tag_actuators = 3;
constexpr std::uint8_t tag_keep_alive = 4;
constexpr std::uint8_t tag_device = 5;

/// The member a tag stands for; nullptr for tags we do not know.
std::uint32_t* member_of(descriptor& x, std::uint8_t tag) {
  switch (tag) {
  case tag_type:
    return &x.type;
  case tag_transducers:
    return &x.transducer_mask;
  case tag_actuators:
    return &x.actuator_mask;
  case tag_keep_alive:
    return &x.keep_alive_ms;
  case tag_device:
    return &x.device;
  default:
    return nullptr;
  }
}

} // namespace

bytes encode(const descriptor& x) {
  byte_writer out;
  const auto field = [&out](std::uint8_t tag, std::uint32_t value) {
    out.octet(tag).octet(sizeof value).big(value);
  };
  field(tag_type, x.type);
  field(tag_transducers, x.transducer_mask);
  field(tag_actuators, x.actuator_mask);
  field(tag_keep_alive, x.keep_alive_ms);
  if (x.device != 0)
    field(tag_device, x.device);
  return out.finish();
}

result<descriptor> decode_descriptor(byte_view octets) {
  byte_reader in(octets);
  descriptor x;
  bool has_type = false;
  while (in.remaining() > 0) {
    const auto tag = in.octet();
    const auto length = in.octet();
    const auto value = in.take(length);
    if (!in.ok())
      return errc::truncated;
    auto* const member = member_of(x, tag);
    if (member == nullptr)
      continue;
    if (length != sizeof *member)
      return errc::bad_value;
    *member = byte_reader(value).big<std::uint32_t>();
    has_type = has_type || tag == tag_type;
  }
  if (!has_type)
    return errc::unsupported;
  return x;
}

} // namespace rubicon::mote
