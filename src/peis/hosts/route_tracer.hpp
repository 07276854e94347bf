// Which hosts packages pass on their route to another, and routes that are to be proved.
#pragma once

#include <optional>
#include <vector>

#include "core/bytes.hpp"
#include "core/time.hpp"
#include "peis/links/package_sender.hpp"
#include "peis/overlay/occasion.hpp"
#include "peis/overlay/overlay.hpp"
#include "peis/overlay/own_peer.hpp"
#include "peis/overlay/route_probes.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

/// A trace is answered by its destination, whatever its kind. Users ask for one; routes that may
/// lead in circles are probed with others.
class route_tracer {
public:
  /// All outlive this.
  route_tracer(own_peer& own, link_table& links, overlay& routes, package_sender& sender);

  /// @pre the host is reachable and not we
  void trace(peer_id destination, request_id id, instant now);
  void on_trace(const package_header& header, byte_view data, const occasion& x);
  void end_late_traces(const occasion& x);

  /// Routes that the overlay has taken though they may lead in circles.
  void probe_unsound(instant now);
  void end_probe(peer_id host) { probes_.end(host); } ///< it lives, or is of no interest any more
  /// @returns hosts that gave no sign of life: the routes to them lead nowhere
  [[nodiscard]] std::vector<way_disproved> probe_due(instant now);

  [[nodiscard]] std::optional<instant> deadline() const;

private:
  struct open_trace {
    peer_id destination;
    request_id id;
    instant deadline;
  };

  void send(peer_id destination, std::size_t attempt);

  own_peer& own_;
  link_table& links_;
  overlay& overlay_;
  package_sender& sender_;
  route_probes probes_;
  std::vector<open_trace> traces_;
};

} // namespace rubicon::peis
