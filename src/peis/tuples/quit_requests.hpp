// Requests that ask other peers to quit, and how they end (TUP-22).
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "core/time.hpp"
#include "peis/tuples/tuple.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

/// Does this value of kernel.do-quit ask to quit (docs/peis-wire.md 18)?
[[nodiscard]] bool asks_to_quit(const tuple& x);

/// Whether a peer quits is its own decision, and no answer says so: after its acknowledgement it
/// vanishes within 6 s, or has refused.
class quit_requests {
public:
  /// The request is sent next.
  void expect(request_id request, peer_id owner);

  /// The owner has acknowledged it. @returns false: no such request
  bool on_delivered(request_id request, instant now);
  void on_undelivered(request_id request);

  /// Requests that succeeded by the end of that host.
  [[nodiscard]] std::vector<request_id> take_succeeded(peer_id vanished);
  /// Requests whose owner is still there.
  [[nodiscard]] std::vector<request_id> take_refused(instant now);

  [[nodiscard]] std::optional<instant> deadline() const; ///< of take_refused()

private:
  struct pending {
    peer_id owner;
    std::optional<instant> until; ///< set: acknowledged
  };

  template <class Condition>
  [[nodiscard]] std::vector<request_id> take_if(Condition ended);

  std::map<request_id, pending> pending_;
};

} // namespace rubicon::peis
