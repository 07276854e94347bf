#include "peis/tuple_record.hpp"

#include <algorithm>

#include "peis/layout.hpp"

namespace rubicon::peis {

namespace {

constexpr std::size_t key_at = 84;
constexpr std::size_t key_size = 128;
constexpr std::size_t force_size = 4;

using record_writer = layout_writer<tuple_record_size>;

void write_time(record_writer& to, std::size_t offset, timestamp x) {
  to.big(offset, x.seconds).big(offset + 4, x.microseconds);
}

timestamp read_time(const layout_reader& from, std::size_t offset) {
  return {from.big<std::int32_t>(offset), from.big<std::int32_t>(offset + 4)};
}

bool wildcard(timestamp x) {
  return x.seconds == -1 || x.microseconds == -1;
}

std::size_t mimetype_length(const layout_reader& from) {
  const auto length = from.octet(36);
  return length == 255 ? 0 : length;
}

record_writer prototype_record(const prototype& x) {
  record_writer to;
  to.big(0, x.owner.value).big(4, x.creator.value);
  for (const std::size_t offset : {8U, 16U, 24U})
    write_time(to, offset, any_time);
  to.big(32, static_cast<std::int32_t>(x.form));
  to.text(key_at, key_size, x.name.text());
  to.big(212, std::int32_t{-1}).big(216, std::int32_t{-1}).big(220, std::int32_t{-1});
  return to;
}

std::string_view up_to_nul(byte_view octets) {
  const std::string_view all(reinterpret_cast<const char*>(octets.data()), octets.size());
  return all.substr(0, all.find('\0'));
}

bool equal_without_case(std::string_view a, std::string_view b) {
  const auto lower = [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [&](char x, char y) { return lower(x) == lower(y); });
}

/// Values compare by length and then without case up to the first NUL (peis-wire.md 15.7).
bool equal_values(const payload& a, const payload& b) {
  return a.size() == b.size() && equal_without_case(up_to_nul(a.view()), up_to_nul(b.view()));
}

result<std::string> mimetype_after_record(byte_view octets) {
  const auto length = mimetype_length(layout_reader(octets));
  if (octets.size() < tuple_record_size + length)
    return errc::truncated;
  return to_string(octets.subspan(tuple_record_size, length));
}

} // namespace

bool prototype::matches(const tuple& x) const {
  return (owner == any_peer || owner == x.owner) && (creator == any_peer || creator == x.creator) &&
         (form == encoding::any || form == x.form) && (!mimetype || *mimetype == x.mimetype) &&
         (!value || equal_values(*value, x.value)) && name.matches(x.name);
}

bool operator==(const prototype& a, const prototype& b) {
  const bool values =
      a.value.has_value() == b.value.has_value() && (!a.value || equal_values(*a.value, *b.value));
  return values && a.owner == b.owner && a.name == b.name && a.creator == b.creator &&
         a.form == b.form && a.mimetype == b.mimetype;
}

bytes encode_tuple_head(const tuple& x, tuple_message_kind kind) {
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
  to.big(212, std::int32_t{1}).big(216, x.seqno);
  bytes out;
  out.reserve(tuple_record_size + x.mimetype.size());
  to.append_to(out);
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

result<tuple> decode_tuple_message(bytes octets) {
  auto name = decode_record_key(octets);
  if (!name)
    return name.error();
  auto mimetype = mimetype_after_record(octets);
  if (!mimetype)
    return mimetype.error();
  const layout_reader from(octets);
  tuple x;
  x.owner = peer_id{from.big<std::int32_t>(0)};
  x.creator = peer_id{from.big<std::int32_t>(4)};
  x.written = read_time(from, 8);
  x.user_time = read_time(from, 16);
  x.expiry = read_time(from, 24);
  x.form = static_cast<encoding>(from.big<std::int32_t>(32));
  x.seqno = from.big<std::int32_t>(216);
  const auto head = tuple_record_size + mimetype->size();
  if (x.owner.value <= 0 || x.creator.value <= 0 || wildcard(x.user_time) || wildcard(x.expiry) ||
      (x.form != encoding::text && x.form != encoding::binary) || name->is_pattern() ||
      mimetype->empty() || from.big<std::uint32_t>(40) == 0 || octets.size() == head)
    return errc::bad_value;
  x.name = std::move(*name);
  x.mimetype = std::move(*mimetype);
  if (x.mimetype != empty_mimetype) {
    octets.erase(octets.begin(), octets.begin() + static_cast<std::ptrdiff_t>(head));
    x.value = payload(std::move(octets));
  }
  return x;
}

bytes encode(const subscribe_message& message) {
  const auto& x = message.wanted;
  auto record = prototype_record(x);
  record.octet(36, x.mimetype ? static_cast<std::uint8_t>(x.mimetype->size()) : 0);
  if (x.value)
    record.octet(43, 1).big(44, static_cast<std::uint32_t>(x.value->size()));
  bytes out{1, 0, 0, 0}; // "force resend", in little-endian order
  if (message.lifetime)
    out = {'R', 'L', std::uint8_t{message.lifetime->refresh}, message.lifetime->seconds};
  record.append_to(out);
  if (x.mimetype)
    out.insert(out.end(), x.mimetype->begin(), x.mimetype->end());
  if (x.value)
    out.insert(out.end(), x.value->view().begin(), x.value->view().end());
  return out;
}

result<subscribe_message> decode_subscribe(byte_view octets) {
  if (octets.size() < force_size + tuple_record_size)
    return errc::truncated;
  const auto force = octets.first(force_size);
  const auto body = octets.subspan(force_size);
  auto name = decode_record_key(body);
  if (!name)
    return name.error();
  auto mimetype = mimetype_after_record(body);
  if (!mimetype)
    return mimetype.error();
  const layout_reader from(body);
  subscribe_message x;
  x.wanted.owner = peer_id{from.big<std::int32_t>(0)};
  x.wanted.name = std::move(*name);
  x.wanted.creator = peer_id{from.big<std::int32_t>(4)};
  x.wanted.form = static_cast<encoding>(from.big<std::int32_t>(32));
  if (x.wanted.form < encoding::any || x.wanted.form > encoding::binary)
    return errc::bad_value;
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
  auto record = prototype_record(unwanted);
  record.octet(36, 255);
  return to_bytes(record.view());
}

result<prototype> decode_unsubscribe(byte_view octets) {
  auto name = decode_record_key(octets);
  if (!name)
    return name.error();
  prototype x;
  x.owner = peer_id{layout_reader(octets).big<std::int32_t>(0)};
  x.name = std::move(*name);
  return x;
}

} // namespace rubicon::peis
