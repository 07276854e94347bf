#include "peis/hosts/clock_service.hpp"

#include <algorithm>
#include <utility>

namespace rubicon::peis {

clock_service::clock_service(own_peer& own, const link_table& links, const host_table& hosts,
                             package_sender& sender, instant now)
    : own_(own), links_(links), hosts_(hosts), sender_(sender),
      clock_({own.config.time_master, own.config.clock_period, own.config.clock_offset,
              own.config.clock_ppb},
             own.config.id, now) {}

/// Is the time in this broadcast's last octets what its route took?
bool clock_service::measures_route(const package_header& header) const {
  const auto* record = hosts_.record_of(header.source);
  return record != nullptr && record->marked;
}

void clock_service::on_message(link_id from, const package_header& header, byte_view data,
                               instant now) {
  const auto message = decode_clock(data, clock_.at(now));
  if (!message) {
    ++own_.counters.malformed;
    return;
  }
  const bool marked = measures_route(header);
  const auto last_link = links_.at(from).signs.one_way.value_or(0s);
  clock_.on_message(*message, header.source, marked ? message->in_flight + last_link : 0s, marked,
                    now);
  broadcasts_ = broadcasts_ && clock_.deadline() <= now + own_.config.clock_period;
}

/// What follows the message goes on as it is.
bytes clock_service::relayed(link_id from, const package_header& header, byte_view data) const {
  auto octets = to_bytes(data);
  if (header.type != package_type::broadcast || header.port != port::clock ||
      !measures_route(header))
    return octets;
  if (auto message = decode_clock(data, clock_.offset())) {
    message->in_flight += links_.at(from).signs.one_way.value_or(0s);
    std::ranges::copy(encode(*message), octets.begin());
  }
  return octets;
}

void clock_service::on_time(instant now) {
  if (clock_.deadline() > now)
    return;
  const bool begins = !std::exchange(broadcasts_, true);
  if (begins && hosts_.all().size() >= hosts_many) {
    clock_.put_off(now + own_.rng.between(duration(0), own_.config.clock_period));
    return;
  }
  if (const auto message = clock_.on_time(now); message && links_.size() > 0)
    static_cast<void>(sender_.broadcast(port::clock, encode(*message), own_origin));
}

} // namespace rubicon::peis
