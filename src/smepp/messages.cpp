#include "smepp/messages.hpp"

#include <algorithm>
#include <array>
#include <cassert>

#include "core/codec.hpp"
#include "smepp/message_fields.hpp"

namespace rubicon::smepp {

namespace {

/// In the order of `message`.
constexpr std::array<std::uint8_t, std::variant_size_v<message>> kinds{
    0x01, 0x02, 0x03, 0x04, 0x05, 0x06, 0x07, 0x10, 0x11,
    0x12, 0x13, 0x15, 0x16, 0x17, 0x18, 0x19, 0x1a};
constexpr std::uint8_t refresh_kind = 0x14;

constexpr std::array<std::string_view, kinds.size()> names{
    "discover",    "answer",        "join",        "join_challenge", "join_proof", "join_accept",
    "join_refuse", "member_joined", "member_left", "member_list",    "subscribe",  "unsubscribe",
    "event",       "sync_stamp",    "key_refresh", "challenge",      "proof"};

// ---- one message each

void write(byte_writer& to, const discover& x) {
  const auto flag = [](bool set, int bit) { return (set ? 1 : 0) << bit; };
  to.big(x.nonce).octet(static_cast<std::uint8_t>(
      flag(x.is_closed.has_value(), 0) | flag(x.is_private.has_value(), 1) |
      flag(x.is_closed.value_or(false), 2) | flag(x.is_private.value_or(false), 3) |
      flag(x.proof.has_value(), 4) | flag(!x.name.empty(), 5)));
  if (x.proof)
    write_tag(to, *x.proof);
  if (!x.name.empty())
    write_text(to, x.name, group_description::name_max);
}

discover read_discover(field_reader& from) {
  discover x;
  x.nonce = from.big<std::uint64_t>();
  const auto flags = from.flags(0x3f);
  if ((flags & 1) != 0)
    x.is_closed = (flags & 4) != 0;
  if ((flags & 2) != 0)
    x.is_private = (flags & 8) != 0;
  from.demand((flags & 1) != 0 || (flags & 4) == 0);
  from.demand((flags & 2) != 0 || (flags & 8) == 0);
  if ((flags & 0x10) != 0)
    x.proof = from.mac();
  if ((flags & 0x20) != 0) {
    x.name = from.text(group_description::name_max);
    from.demand(!x.name.empty());
  }
  return x;
}

void write(byte_writer& to, const answer& x) {
  assert(!x.name.empty() && x.name.size() <= group_description::name_max);
  to.big(x.nonce)
      .big(x.group.value)
      .octet(static_cast<std::uint8_t>((x.is_closed ? 1 : 0) | (x.is_private ? 2 : 0) |
                                       (x.proof ? 4 : 0)))
      .octet(x.members)
      .big(x.period_ms)
      .big(x.length_ms);
  write(to, x.time);
  if (x.proof)
    write_tag(to, *x.proof);
  to.octet(static_cast<std::uint8_t>(x.name.size())).append(x.name);
}

answer read_answer(field_reader& from) {
  answer x;
  x.nonce = from.big<std::uint64_t>();
  x.group = from.group();
  const auto flags = from.flags(7);
  x.is_closed = (flags & 1) != 0;
  x.is_private = (flags & 2) != 0;
  x.members = from.octet();
  x.period_ms = from.big<std::uint16_t>();
  x.length_ms = from.big<std::uint16_t>();
  from.demand(x.period_ms == 0 || (x.length_ms > 0 && x.length_ms <= x.period_ms));
  x.time = read_group_time(from);
  if ((flags & 4) != 0)
    x.proof = from.mac();
  from.demand(x.proof || !x.is_private);
  x.name = from.sized(group_description::name_max);
  from.demand(!x.name.empty());
  from.demand(x.is_private || is_name(rubicon::to_string(x.name), group_description::name_max));
  return x;
}

void write(byte_writer& to, const join& x) {
  to.big(x.group.value).big(x.nonce);
}

join read_join(field_reader& from) {
  join x;
  x.group = from.group();
  x.nonce = from.big<std::uint32_t>();
  return x;
}

void write(byte_writer& to, const join_challenge& x) {
  to.big(x.group.value).big(x.nonce);
  write_tag(to, x.cookie);
}

join_challenge read_join_challenge(field_reader& from) {
  join_challenge x;
  x.group = from.group();
  x.nonce = from.big<std::uint32_t>();
  x.cookie = from.mac();
  return x;
}

void write(byte_writer& to, const join_proof& x) {
  to.big(x.group.value).big(x.nonce);
  write_tag(to, x.cookie);
  to.big(x.transducers).octet(x.is_member ? 1 : 0).append(x.share).append(x.identity);
  write_tag(to, x.proof);
}

join_proof read_join_proof(field_reader& from) {
  join_proof x;
  x.group = from.group();
  x.nonce = from.big<std::uint32_t>();
  x.cookie = from.mac();
  x.transducers = from.big<std::uint32_t>();
  x.is_member = from.flags(1) != 0;
  x.share = from.share();
  x.identity = from.share();
  x.proof = from.mac();
  return x;
}

void write(byte_writer& to, const join_accept& x) {
  to.big(x.group.value).big(x.nonce).append(x.share);
  write(to, x.keys);
  to.octet(x.members).octet(x.subscriptions);
  write(to, x.time);
}

join_accept read_join_accept(field_reader& from) {
  join_accept x;
  x.group = from.group();
  x.nonce = from.big<std::uint32_t>();
  x.share = from.share();
  x.keys = read_wrapped(from);
  x.members = from.octet();
  x.subscriptions = from.octet();
  x.time = read_group_time(from);
  return x;
}

void write(byte_writer& to, const join_refuse& x) {
  to.big(x.group.value).big(x.nonce).octet(static_cast<std::uint8_t>(x.why));
  write_tag(to, x.mac);
}

join_refuse read_join_refuse(field_reader& from) {
  join_refuse x;
  x.group = from.group();
  x.nonce = from.big<std::uint32_t>();
  const auto why = from.octet();
  from.demand(why >= 1 && why <= 3);
  x.why = static_cast<failure>(why);
  x.mac = from.mac();
  return x;
}

void write(byte_writer& to, const member_joined& x) {
  write(to, x.who);
}

member_joined read_joined(field_reader& from) {
  member_joined x{read_member(from)};
  from.demand(!x.who.has_left);
  return x;
}

void write(byte_writer& to, const member_left& x) {
  write(to, x.who);
}

member_left read_left(field_reader& from) {
  member_left x{read_member(from)};
  from.demand(x.who.has_left);
  return x;
}

void write(byte_writer& to, const member_list& x) {
  assert(!x.all.empty() && x.all.size() <= member_list::count_max);
  to.octet(static_cast<std::uint8_t>(x.all.size()));
  for (const auto& each : x.all)
    write(to, each);
}

member_list read_members(field_reader& from) {
  member_list x;
  const std::size_t count = from.octet();
  from.demand(count >= 1 && count <= member_list::count_max);
  for (std::size_t i = 0; i < count && from.ok() && from.good(); ++i)
    x.all.push_back(read_member(from));
  return x;
}

void write(byte_writer& to, const subscribe& x) {
  assert(!x.name.empty());
  write(to, x.id);
  to.big(x.round).octet(x.hops);
  write(to, x.made_at);
  write(to, x.expires);
  to.big(x.interval_ms);
  write_text(to, x.name, event_name_max);
}

subscribe read_subscribe(field_reader& from) {
  subscribe x;
  x.id = read_subscription(from);
  x.round = from.big<std::uint16_t>();
  x.hops = from.octet();
  x.made_at = read_group_time(from);
  x.expires = read_group_time(from);
  x.interval_ms = from.big<std::uint32_t>();
  x.name = from.text(event_name_max);
  from.demand(!x.name.empty());
  return x;
}

void write(byte_writer& to, const unsubscribe& x) {
  write(to, x.id);
  write(to, x.made_at);
}

unsubscribe read_unsubscribe(field_reader& from) {
  unsubscribe x;
  x.id = read_subscription(from);
  x.made_at = read_group_time(from);
  return x;
}

void write(byte_writer& to, const event& x) {
  assert(x.value.size() <= event_value_max);
  write(to, x.id);
  to.big(x.producer.value).big(x.sequence).octet(x.hops).octet(x.proof ? 1 : 0);
  if (x.proof) {
    to.big(x.proof->number);
    write_tag(to, x.proof->mac);
  }
  to.append(x.value);
}

event read_event(field_reader& from) {
  event x;
  x.id = read_subscription(from);
  x.producer = from.mote();
  x.sequence = from.big<std::uint16_t>();
  x.hops = from.octet();
  if (from.flags(1) != 0) {
    const auto number = from.big<std::uint64_t>();
    x.proof = sender_proof{number, from.mac()};
  }
  x.value = to_bytes(from.rest());
  from.demand(x.value.size() <= event_value_max);
  return x;
}

void write(byte_writer& to, const sync_stamp& x) {
  to.big(x.sequence).octet(x.of_last ? 1 : 0);
  write(to, x.of_last.value_or(group_time{}));
  write(to, x.now);
  to.big(x.root.value).big(x.round).octet(x.hops).big(x.digest);
  write(to, x.best);
}

sync_stamp read_sync(field_reader& from) {
  sync_stamp x;
  x.sequence = from.big<std::uint16_t>();
  const bool is_set = from.flags(1) != 0;
  const auto of_last = read_group_time(from);
  if (is_set)
    x.of_last = of_last;
  from.demand(is_set || of_last == group_time{});
  x.now = read_group_time(from);
  x.root = from.mote();
  x.round = from.big<std::uint16_t>();
  x.hops = from.octet();
  x.digest = from.big<std::uint16_t>();
  x.best = read_session(from);
  return x;
}

void write(byte_writer& to, const key_refresh& x) {
  write(to, x.keys);
}

void write(byte_writer& to, const challenge& x) {
  to.big(x.nonce);
}

void write(byte_writer& to, const proof& x) {
  to.big(x.nonce);
}

message read_body(std::uint8_t kind, field_reader& from) {
  switch (kind) {
  case 0x01:
    return read_discover(from);
  case 0x02:
    return read_answer(from);
  case 0x03:
    return read_join(from);
  case 0x04:
    return read_join_challenge(from);
  case 0x05:
    return read_join_proof(from);
  case 0x06:
    return read_join_accept(from);
  case 0x07:
    return read_join_refuse(from);
  case 0x10:
    return read_joined(from);
  case 0x11:
    return read_left(from);
  case 0x12:
    return read_members(from);
  case 0x15:
    return read_unsubscribe(from);
  case 0x16:
    return read_event(from);
  case 0x17:
    return read_sync(from);
  case 0x18:
    return key_refresh{read_wrapped(from)};
  case 0x19:
    return challenge{from.big<std::uint64_t>()};
  case 0x1a:
    return proof{from.big<std::uint64_t>()};
  default: {
    auto x = read_subscribe(from);
    x.is_refresh = kind == refresh_kind;
    return x;
  }
  }
}

} // namespace

std::string_view to_string(failure x) {
  switch (x) {
  case failure::wrong_master_key:
    return "wrong_master_key";
  case failure::group_full:
    return "group_full";
  case failure::not_admitted:
    return "not_admitted";
  case failure::unknown_group:
    return "unknown_group";
  case failure::no_answer:
    return "no_answer";
  case failure::no_room:
    return "no_room";
  case failure::not_a_member:
    return "not_a_member";
  case failure::bad_argument:
    return "bad_argument";
  case failure::name_taken:
    return "name_taken";
  }
  return "";
}

bool is_network_level(const message& x) {
  return kinds.at(x.index()) < 0x10;
}

std::string_view name_of(const message& x) {
  return names.at(x.index());
}

bytes encode(const message& x) {
  byte_writer to;
  const auto* const subscribing = std::get_if<subscribe>(&x);
  to.octet(subscribing != nullptr && subscribing->is_refresh ? refresh_kind : kinds.at(x.index()));
  std::visit([&](const auto& body) { write(to, body); }, x);
  assert(to.size() <= message_max);
  return to.finish();
}

result<message> decode(byte_view octets) {
  field_reader from(octets);
  const auto kind = from.octet();
  if (!from.ok())
    return errc::truncated;
  if (kind != refresh_kind && std::ranges::find(kinds, kind) == kinds.end())
    return errc::unsupported;
  auto x = read_body(kind, from);
  if (!from.good() && from.ok())
    return errc::bad_value;
  if (!from.ok())
    return errc::truncated;
  if (from.remaining() > 0)
    return errc::too_long;
  return x;
}

} // namespace rubicon::smepp
