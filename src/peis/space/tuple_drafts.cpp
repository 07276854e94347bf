#include "peis/space/tuple_drafts.hpp"

#include <limits>

#include "peis/space/tuple_space_config.hpp"
#include "peis/tuples/tuple_record.hpp"
#include "peis/wire/package.hpp"

namespace rubicon::peis {

std::optional<tuple> tuple_drafts::draft(peer_id owner, const key& name,
                                         tuple_content content) const {
  tuple x;
  x.owner = owner;
  x.name = name;
  x.form = content.form;
  x.mimetype = std::move(content.mimetype);
  x.value = std::move(content.value);
  if (content.expiry) {
    const auto expiry = clock_.to_timestamp(*content.expiry);
    if (!expiry)
      return std::nullopt;
    x.expiry = *expiry;
  }
  return x;
}

cause tuple_drafts::complete(tuple& x, instant now) const {
  if (x.owner == any_peer || x.name.is_pattern() || is_wildcard(x.user_time) ||
      is_wildcard(x.expiry) || x.form == encoding::any || x.mimetype.empty())
    return cause::abstract;
  if (x.owner.value <= 0 || x.mimetype.size() > mimetype_length_max)
    return cause::bad_value;
  if (x.value.size() > tuple_value_max)
    return cause::too_long;
  const auto written = clock_.network_time(now);
  if (x.expiry.seconds > written.seconds + std::numeric_limits<std::int32_t>::max())
    return cause::bad_value; // others would take it for a time in the past
  if (x.value.empty())
    x.mimetype = empty_mimetype;
  x.creator = self_;
  x.written = written;
  x.seqno = x.append_seqno = 0;
  x.stale = false;
  return cause::none;
}

std::pair<cause, transmit> tuple_drafts::ask_to_set(tuple x, request_id request,
                                                    instant now) const {
  const auto why = complete(x, now);
  if (why != cause::none)
    return {why, {}};
  return {cause::none,
          {x.owner,
           port::set,
           {encode_tuple_head(x, tuple_message_kind::set), encode_tuple_value(x)},
           request}};
}

std::pair<cause, transmit> tuple_drafts::ask_to_delete(peer_id owner, const key& name,
                                                       request_id request, instant now) const {
  if (name.is_pattern())
    return {cause::bad_key, {}};
  tuple x;
  x.owner = owner;
  x.name = name;
  make_deletion(x);
  return ask_to_set(std::move(x), request, now);
}

void make_deletion(tuple& x) {
  x.expiry = deleted;
  x.value = payload(bytes{0});
}

} // namespace rubicon::peis
