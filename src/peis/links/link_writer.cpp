#include "peis/links/link_writer.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include "core/account/message_ledger.hpp"

namespace rubicon::peis {

void link_writer::pace(connection& x, events& out) const {
  if (x.out.paced || own_.config.link_window == 0)
    return;
  x.out.paced = true;
  out.push_back(pace_link{x.id});
}

void link_writer::on_sent(connection& x, std::size_t octets, instant now) {
  auto& sent = x.out;
  sent.unreported -= std::min(octets, sent.unreported);
  sent.drained = now;
  while (!sent.leaving.empty() && sent.leaving.front().first + sent.unreported <= sent.octets) {
    messages_.on_transmitted(sent.leaving.front().second, now);
    sent.leaving.pop_front();
  }
}

/// May so many octets more be handed out, and a package?
bool link_writer::has_window(const connection& to, std::size_t more) const {
  const auto all = to.out.unreported + more;
  if (to.out.paced)
    return all == 0 || all + header_size + data_max <= own_.config.paced_window;
  return own_.config.link_window == 0 || all < own_.config.link_window;
}

bool link_writer::write(connection& to, instant now, events& out) {
  if (to.out.queue.empty() || !to.open)
    return false;
  bytes octets = std::exchange(to.out.preamble, {});
  bool any = false;
  while (has_window(to, octets.size()) && encode_next(to, octets, now)) {
    any = true;
    if (to.out.paced)
      hand_out(to, std::exchange(octets, {}), now, out);
  }
  if (octets.empty())
    return any;
  hand_out(to, std::move(octets), now, out);
  return true;
}

/// The next package that is still wanted. @returns false if there is none
bool link_writer::encode_next(connection& to, bytes& octets, instant now) {
  for (auto x = to.out.queue.pop(); x; x = to.out.queue.pop()) {
    const bool awaited = x->header.reliable() && x->header.source == own_.self.id;
    if (awaited && !messages_.is_wanted(x->header.ack_id))
      continue;
    if (carries_content(x->header.port)) {
      const acting_on its(x->from);
      static_cast<void>(provenance::begin("package_sent", name_of(x->header)));
      package_departs(name_of(x->header), to.id >= own_.config.outside_from);
    }
    encode(*x, to.out.counter++, octets);
    if (to.id >= own_.config.outside_from && x->header.port == port::host_record && x->offset == 0)
      hide_inproc(std::span(octets).last(x->length()));
    ++own_.counters.packages_sent;
    if (awaited && own_.config.link_window == 0)
      messages_.on_transmitted(x->header.ack_id, now);
    else if (awaited) // the wait for an acknowledgement begins when it has left
      to.out.leaving.emplace_back(to.out.octets + octets.size(), x->header.ack_id);
    return true;
  }
  return false;
}

void link_writer::hand_out(connection& to, bytes octets, instant now, events& out) {
  own_.counters.octets_sent += octets.size();
  to.out.octets += octets.size();
  to.out.last_written = now;
  const bool waited = to.out.unreported > 0;
  to.out.drained = waited ? to.out.drained : now;
  to.out.unreported += own_.config.link_window == 0 ? 0 : octets.size();
  if (!waited)
    health_.watch_suspicion(to);
  out.push_back(to_link{to.id, std::move(octets)});
}

} // namespace rubicon::peis
