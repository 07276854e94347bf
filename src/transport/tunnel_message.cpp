#include "transport/tunnel_message.hpp"

#include "core/codec.hpp"

namespace rubicon::transport {

namespace {

using kind = tunnel_message::kind;

constexpr std::uint8_t flag_acceptor = 0x80;

bool is_well_formed(const tunnel_message& x) {
  const bool by_acceptor_only = x.what == kind::accept || x.what == kind::refuse;
  const bool right_end = x.from_acceptor ? x.what != kind::connect : !by_acceptor_only;
  const bool may_not_know = x.what == kind::connect || (x.what == kind::close && !x.from_acceptor);
  const bool lives_can_be = x.opener != 0 && (x.acceptor != 0 || may_not_know) &&
                            (x.acceptor == 0 || x.what != kind::connect);
  return right_end && lives_can_be && x.sender != broadcast_mote && x.sender != own_mote &&
         (x.content.empty() || x.what == kind::data);
}

} // namespace

bytes encode(const tunnel_message& x) {
  byte_writer out;
  out.octet(
      static_cast<std::uint8_t>((x.from_acceptor ? flag_acceptor : 0) | static_cast<int>(x.what)));
  out.big(x.sender.value).big(x.receiver.value).big(x.number);
  out.octet(static_cast<std::uint8_t>(x.opener << 4 | x.acceptor));
  out.append(x.content);
  return out.finish();
}

result<tunnel_message> decode_tunnel_message(byte_view octets) {
  byte_reader in(octets);
  tunnel_message x;
  const auto first = in.octet();
  x.sender = mote_id{in.big<std::uint16_t>()};
  x.receiver = mote_id{in.big<std::uint16_t>()};
  x.number = in.big<std::uint16_t>();
  const auto lives = in.octet();
  if (!in.ok())
    return errc::truncated;
  if (in.remaining() > tunnel_content_max)
    return errc::too_long;
  const auto what = first & ~flag_acceptor;
  if (what < 1 || what > 6)
    return errc::unsupported;
  x.what = static_cast<kind>(what);
  x.from_acceptor = (first & flag_acceptor) != 0;
  x.opener = lives >> 4;
  x.acceptor = lives & 0x0f;
  x.content = to_bytes(in.rest());
  if (!is_well_formed(x))
    return errc::bad_value;
  return x;
}

} // namespace rubicon::transport
