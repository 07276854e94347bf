#include "peis/tuples/tuple.hpp"

#include <utility>

namespace rubicon::peis {

namespace {

std::string_view up_to_nul(byte_view octets) {
  const std::string_view all(reinterpret_cast<const char*>(octets.data()), octets.size());
  return all.substr(0, all.find('\0'));
}

bool equal_values(const payload& a, const payload& b) {
  return a.size() == b.size() && equal_without_case(up_to_nul(a.view()), up_to_nul(b.view()));
}

bool covers(timestamp wanted, timestamp x) {
  return (wanted.seconds == -1 || wanted.seconds == x.seconds) &&
         (wanted.microseconds == -1 || wanted.microseconds == x.microseconds);
}

} // namespace

tuple_content text_content(std::string_view text, std::optional<instant> expiry) {
  auto octets = to_bytes(text);
  octets.push_back(0);
  return {std::move(octets), std::string(text_mimetype), encoding::text, expiry};
}

tuple_content binary_content(payload octets, std::optional<instant> expiry) {
  return {std::move(octets), std::string(binary_mimetype), encoding::binary, expiry};
}

std::string_view tuple::text() const {
  return up_to_nul(value.view());
}

bool prototype::matches(const tuple& x) const {
  return names(x) && (creator == any_peer || creator == x.creator) && covers(written, x.written) &&
         covers(user_time, x.user_time) && covers(expiry, x.expiry) &&
         (form == encoding::any || form == x.form) && (!mimetype || *mimetype == x.mimetype) &&
         (!value || equal_values(*value, x.value));
}

bool operator==(const prototype& a, const prototype& b) {
  const bool values =
      a.value.has_value() == b.value.has_value() && (!a.value || equal_values(*a.value, *b.value));
  return values && a.owner == b.owner && a.name == b.name && a.creator == b.creator &&
         a.written == b.written && a.user_time == b.user_time && a.expiry == b.expiry &&
         a.form == b.form && a.mimetype == b.mimetype;
}

prototype prototype_of(peer_id owner, key pattern) {
  prototype x;
  x.owner = owner;
  x.name = std::move(pattern);
  return x;
}

} // namespace rubicon::peis
