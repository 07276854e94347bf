// Messages for one host: sent in packages, repeated, acknowledged, put together (peis-wire.md 8).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "core/bytes.hpp"
#include "core/time.hpp"
#include "peis/delivery/acknowledger.hpp"
#include "peis/delivery/delivery.hpp"
#include "peis/delivery/reassembly.hpp"
#include "peis/link/fair_share.hpp"
#include "peis/link/traffic_meter.hpp"
#include "peis/links/package_sender.hpp"
#include "peis/overlay/link_table.hpp"
#include "peis/overlay/occasion.hpp"
#include "peis/overlay/overlay.hpp"
#include "peis/overlay/own_peer.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

/// One message to one peer; how it ended comes as an event, at once for what is known at once.
struct posting {
  peer_id destination;
  std::uint16_t port = 0;
  message_octets content;
  bool reliable = true;
  priority class_of_service = priority::normal;
  request_id id;
  std::optional<link_id> for_neighbour = std::nullopt; ///< an answer to what came over this link
};

/// Brings what `delivery` keeps into the queues of links, as far as windows and queues have room,
/// and what `reassembly` and `acknowledger` keep to an end.
class message_delivery {
public:
  /// All outlive this.
  message_delivery(own_peer& own, link_table& links, const overlay& routes, package_sender& sender,
                   traffic_meter& traffic);

  void send(posting x, link_id origin, events& out);
  /// May another message answer what came over this link? A link may have as many answers in
  /// flight as are free beside them.
  [[nodiscard]] bool may_answer(link_id from) const;

  // What has come.
  /// Would this fragment be taken?
  [[nodiscard]] bool accepts(const package_header& header, link_id from) const {
    return assembly_.accepts(header, from);
  }
  /// @returns the message that it completes
  [[nodiscard]] std::optional<bytes> add(const package_header& header, byte_view data, link_id from,
                                         instant now) {
    return assembly_.add(header, data, now, from);
  }
  void acknowledge(const package_header& header, link_id origin, instant now);
  void on_acknowledgement(byte_view data, events& out);

  // What happens to packages of ours.
  [[nodiscard]] bool is_wanted(std::int32_t ack_id) const { return reliable_.wanted(ack_id); }
  void on_transmitted(std::int32_t ack_id, instant now) { reliable_.on_transmitted(ack_id, now); }
  /// Over this link nothing leaves any more.
  void on_link_closed(connection& gone, instant now, events& out);
  void on_host_gone(peer_id host, events& out);

  void on_time(instant now) { own_.counters.messages_incomplete += assembly_.on_time(now); }
  void repeat_due(instant now, events& out);
  void acknowledge_due(instant now);
  void begin_stale_anew(events& out);
  void continue_stalled(events& out); ///< after links have been written to
  [[nodiscard]] std::optional<instant> deadline() const;

  /// Messages that are being put together take of this memory as well. @pre nothing has come yet
  void share_memory(std::shared_ptr<fair_share> x) { assembly_.use_memory(std::move(x)); }

private:
  [[nodiscard]] cause send_unreliable(const posting& x, link_id hop, link_id origin);
  [[nodiscard]] bool add_reliable(posting& x);
  void pump(peer_id destination, events& out);
  void begin_anew(const std::set<peer_id>& destinations, events& out);
  void fail(const reliable_message& x, cause why, events& out);
  void on_ended(const reliable_message& x);
  void send_acknowledgements(peer_id to, const std::vector<std::int32_t>& ids, link_id origin);

  own_peer& own_;
  link_table& links_;
  const overlay& overlay_;
  package_sender& sender_;
  traffic_meter& traffic_;
  reassembly assembly_;
  acknowledger acknowledger_;
  delivery reliable_;
  std::set<peer_id> stalled_; ///< destinations whose next package found its queue half full
  std::map<link_id, std::size_t> answers_; ///< in flight, by the link of the question
  std::size_t answers_open_ = 0;
};

} // namespace rubicon::peis
