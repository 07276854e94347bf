// What the owner of a kernel subscribes to.
#pragma once

#include <string_view>

#include "core/time.hpp"
#include "peis/kernel/kernel_layers.hpp"
#include "peis/tuples/tuple.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

/// Names in brackets are those of D1.1 3.1.3.
class subscription_commands {
public:
  /// @param layers outlive this
  explicit subscription_commands(kernel_layers& layers) : layers_(layers) {}

  /// [subscribe] To the tuples of `owner` (or any_peer, which includes our own) whose keys match
  /// `pattern`, now and of hosts that join later (TUP-08, TUP-11). What matches already is among
  /// the outputs; from then on each change and deletion is notified once per subscription. The
  /// handle is the caller's `id`: bad_handle if it is in use; space_full.
  [[nodiscard]] outputs subscribe(peer_id owner, std::string_view pattern, subscription_id id,
                                  instant now, request_id request = no_request);
  /// [subscribeByAbstract] To all tuples that match a prototype.
  [[nodiscard]] outputs subscribe(const prototype& wanted, subscription_id id, instant now,
                                  request_id request = no_request);

  /// [registerTupleCallback, ...ByAbstract] Notifies of each match that arrives in this tuple
  /// space from now on, or leaves it, as subscribe() does, but requests none (CB-01).
  [[nodiscard]] outputs register_callback(const prototype& wanted, subscription_id id, instant now,
                                          request_id request = no_request);

  /// [unsubscribe] Ends what subscribe(), register_callback() or their indirect forms began, at any
  /// time (CB-04). Tuples held for no other subscription are forgotten without notice. bad_handle:
  /// no such id.
  [[nodiscard]] outputs unsubscribe(subscription_id id, instant now,
                                    request_id request = no_request);

  /// [subscribeIndirectly] Subscribes to the meta tuple, and always to just the tuple that it
  /// points at: when it is rewritten, the outputs for `id` are those of the new target from that
  /// moment on (META-02). While it points nowhere or is no meta tuple there are none.
  [[nodiscard]] outputs subscribe_indirectly(peer_id meta_owner, std::string_view meta_key,
                                             subscription_id id, instant now,
                                             request_id request = no_request);
  /// [registerMetaTupleCallback] The same without requesting either tuple.
  [[nodiscard]] outputs register_indirect_callback(peer_id meta_owner, std::string_view meta_key,
                                                   subscription_id id, instant now,
                                                   request_id request = no_request);

private:
  using interest = tuple_space::interest;

  [[nodiscard]] outputs watch(const prototype& wanted, interest kind, subscription_id id,
                              request_id request, instant now);
  [[nodiscard]] outputs watch_indirectly(peer_id owner, std::string_view name, interest kind,
                                         subscription_id id, request_id request, instant now);

  kernel_layers& layers_;
};

} // namespace rubicon::peis
