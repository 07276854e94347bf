#include "peis/tuples/tuple_record.hpp"

#include <algorithm>

#include "core/serial_number.hpp"
#include "peis/wire/layout.hpp"

namespace rubicon::peis {

namespace {

constexpr std::size_t key_at = 84;
constexpr std::size_t key_size = 128;
constexpr std::size_t force_size = 4;
constexpr std::size_t length_size = 4;

using record_writer = layout_writer<tuple_record_size>;

/// What 32 bits of seconds say by themselves: that there is no time, that a tuple is to go, and
/// "any" in a prototype.
bool has_own_meaning(std::int32_t seconds) {
  return seconds == never.seconds || seconds == deleted.seconds || seconds == any_time.seconds;
}

void write_time(record_writer& to, std::size_t offset, timestamp x) {
  auto low = static_cast<std::int32_t>(x.seconds);
  if (low != x.seconds && has_own_meaning(low))
    low = static_cast<std::int32_t>(deleted.seconds) + 1; // 3 s late at most, once in 136 years
  to.big(offset, low).big(offset + 4, x.microseconds);
}

/// Seconds as they are on the wire.
timestamp read_own_time(const layout_reader& from, std::size_t offset) {
  return {from.big<std::int32_t>(offset), from.big<std::int32_t>(offset + 4)};
}

timestamp read_time(const layout_reader& from, std::size_t offset, timestamp known) {
  auto x = read_own_time(from, offset);
  const auto low = static_cast<std::int32_t>(x.seconds);
  if (!has_own_meaning(low))
    x.seconds = unwrapped(static_cast<std::uint32_t>(low), known.seconds);
  return x;
}

std::size_t mimetype_length(const layout_reader& from) {
  const auto length = from.octet(36);
  return length == 255 ? 0 : length;
}

record_writer prototype_record(const prototype& x) {
  record_writer to;
  to.big(0, x.owner.value).big(4, x.creator.value);
  write_time(to, 8, x.written);
  write_time(to, 16, x.user_time);
  write_time(to, 24, x.expiry);
  to.big(32, static_cast<std::int32_t>(x.form));
  if (x.mimetype)
    to.octet(36, static_cast<std::uint8_t>(x.mimetype->size()));
  if (x.value)
    to.octet(43, 1).big(44, static_cast<std::uint32_t>(x.value->size()));
  to.text(key_at, key_size, x.name.text());
  to.big(212, std::int32_t{-1}).big(216, std::int32_t{-1}).big(220, std::int32_t{-1});
  return to;
}

/// The fields that a tuple and a prototype share.
template <class T>
void read_fields(const layout_reader& from, T& x, timestamp known) {
  x.owner = peer_id{from.big<std::int32_t>(0)};
  x.creator = peer_id{from.big<std::int32_t>(4)};
  x.written = read_time(from, 8, known);
  x.user_time = read_own_time(from, 16);
  x.expiry = read_time(from, 24, known);
  x.form = static_cast<encoding>(from.big<std::int32_t>(32));
}

/// Without MIME type and value.
result<prototype> read_prototype(byte_view record, timestamp known) {
  auto name = decode_record_key(record);
  if (!name)
    return name.error();
  const layout_reader from(record);
  prototype x;
  read_fields(from, x, known);
  x.name = std::move(*name);
  if (x.form < encoding::any || x.form > encoding::binary)
    return errc::bad_value;
  return x;
}

record_writer tuple_record(const tuple& x, tuple_message_kind kind) {
  record_writer to;
  to.big(0, x.owner.value).big(4, x.creator.value);
  write_time(to, 8, x.written);
  write_time(to, 16, x.user_time);
  write_time(to, 24, x.expiry);
  to.big(32, static_cast<std::int32_t>(x.form));
  to.octet(36, static_cast<std::uint8_t>(x.mimetype.size()));
  to.octet(kind == tuple_message_kind::push ? 40 : 43, 1);
  to.big(44, static_cast<std::uint32_t>(std::max<std::size_t>(1, x.value.size())));
  to.text(key_at, key_size, x.name.text());
  to.big(212, std::int32_t{1}).big(216, x.seqno).big(220, x.append_seqno);
  return to;
}

void append_length(bytes& out, std::size_t length) {
  for (int shift = 24; shift >= 0; shift -= 8)
    out.push_back(static_cast<std::uint8_t>(length >> static_cast<unsigned>(shift)));
}

/// The octets that a length after the record and `skipped` others announces: all that is left.
result<payload> read_added(const payload& octets, std::size_t skipped) {
  const auto at = tuple_record_size + length_size;
  if (octets.size() < at || octets.size() - at < skipped)
    return errc::truncated;
  const auto count = layout_reader(octets.view()).big<std::uint32_t>(tuple_record_size);
  if (count != octets.size() - at - skipped)
    return errc::bad_value;
  return octets.part(at + skipped, count);
}

result<std::string> mimetype_after_record(byte_view octets) {
  const auto length = mimetype_length(layout_reader(octets));
  if (octets.size() < tuple_record_size + length)
    return errc::truncated;
  return to_string(octets.subspan(tuple_record_size, length));
}

} // namespace

bytes encode_tuple_head(const tuple& x, tuple_message_kind kind) {
  bytes out;
  out.reserve(tuple_record_size + x.mimetype.size());
  tuple_record(x, kind).append_to(out);
  out.insert(out.end(), x.mimetype.begin(), x.mimetype.end());
  return out;
}

payload encode_tuple_value(const tuple& x) {
  return x.value.empty() ? payload(bytes{0}) : x.value;
}

result<key> decode_record_key(byte_view record) {
  if (record.size() < tuple_record_size)
    return errc::truncated;
  const auto text = layout_reader(record).text(key_at, key_size);
  if (!text)
    return errc::bad_value;
  return key::from_wire(*text);
}

result<tuple> decode_tuple_message(const payload& octets, timestamp known) {
  auto name = decode_record_key(octets.view());
  if (!name)
    return name.error();
  auto mimetype = mimetype_after_record(octets.view());
  if (!mimetype)
    return mimetype.error();
  const layout_reader from(octets.view());
  tuple x;
  read_fields(from, x, known);
  x.seqno = from.big<std::int32_t>(216);
  x.append_seqno = from.big<std::int32_t>(220);
  const auto head = tuple_record_size + mimetype->size();
  if (x.owner.value <= 0 || x.creator.value <= 0 || is_wildcard(x.user_time) ||
      is_wildcard(x.expiry) || (x.form != encoding::text && x.form != encoding::binary) ||
      name->is_pattern() || mimetype->empty() || from.big<std::uint32_t>(40) == 0 ||
      octets.size() == head)
    return errc::bad_value;
  x.name = std::move(*name);
  x.mimetype = std::move(*mimetype);
  if (x.mimetype != empty_mimetype)
    x.value = octets.part(head, octets.size() - head);
  return x;
}

bytes encode_append_request_head(const append_request& message) {
  auto out = to_bytes(prototype_record(message.wanted).view());
  append_length(out, message.added.size());
  if (const auto& value = message.wanted.value)
    out.insert(out.end(), value->view().begin(), value->view().end());
  return out;
}

result<append_request> decode_append_request(const payload& octets, timestamp known) {
  auto wanted = read_prototype(octets.view(), known);
  if (!wanted)
    return wanted.error();
  const layout_reader from(octets.view());
  const auto value_size = from.big<std::uint32_t>(44);
  auto added = read_added(octets, value_size);
  if (!added)
    return added.error();
  if (from.big<std::uint32_t>(40) != 0)
    wanted->value = octets.part(tuple_record_size + length_size, value_size);
  return append_request{std::move(*wanted), std::move(*added)};
}

bytes encode_append_notice_head(const tuple& before, std::size_t added) {
  auto out = to_bytes(tuple_record(before, tuple_message_kind::push).view());
  append_length(out, added);
  return out;
}

result<append_notice> decode_append_notice(const payload& octets) {
  auto name = decode_record_key(octets.view());
  if (!name)
    return name.error();
  auto added = read_added(octets, 0);
  if (!added)
    return added.error();
  const layout_reader from(octets.view());
  append_notice x;
  x.owner = peer_id{from.big<std::int32_t>(0)};
  x.name = std::move(*name);
  x.seqno = from.big<std::int32_t>(216);
  x.append_seqno = from.big<std::int32_t>(220);
  x.length = from.big<std::uint32_t>(44);
  x.added = std::move(*added);
  if (x.name.is_pattern() || x.owner.value <= 0)
    return errc::bad_value;
  return x;
}

bytes encode(const subscribe_message& message) {
  const auto& x = message.wanted;
  bytes out{1, 0, 0, 0}; // "force resend", in little-endian order
  if (message.lifetime)
    out = {'R', 'L', std::uint8_t{message.lifetime->refresh}, message.lifetime->seconds};
  prototype_record(x).append_to(out);
  if (x.mimetype)
    out.insert(out.end(), x.mimetype->begin(), x.mimetype->end());
  if (x.value)
    out.insert(out.end(), x.value->view().begin(), x.value->view().end());
  return out;
}

result<subscribe_message> decode_subscribe(byte_view octets, timestamp known) {
  if (octets.size() < force_size + tuple_record_size)
    return errc::truncated;
  const auto force = octets.first(force_size);
  const auto body = octets.subspan(force_size);
  auto wanted = read_prototype(body, known);
  if (!wanted)
    return wanted.error();
  auto mimetype = mimetype_after_record(body);
  if (!mimetype)
    return mimetype.error();
  const layout_reader from(body);
  subscribe_message x{std::move(*wanted), std::nullopt};
  const auto value = body.subspan(tuple_record_size + mimetype->size());
  if (from.big<std::uint32_t>(40) != 0)
    x.wanted.value = payload(to_bytes(value));
  if (!mimetype->empty())
    x.wanted.mimetype = std::move(*mimetype);
  if (force[0] == 'R' && force[1] == 'L')
    x.lifetime = lifetime_tag{force[2] != 0, force[3]};
  return x;
}

bytes encode_unsubscribe(const prototype& unwanted) {
  auto record = prototype_record(prototype_of(unwanted.owner, unwanted.name));
  record.octet(36, 255);
  return to_bytes(record.view());
}

result<prototype> decode_unsubscribe(byte_view octets) {
  auto name = decode_record_key(octets);
  if (!name)
    return name.error();
  return prototype_of(peer_id{layout_reader(octets).big<std::int32_t>(0)}, std::move(*name));
}

} // namespace rubicon::peis
