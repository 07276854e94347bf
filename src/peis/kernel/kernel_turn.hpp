// One call of a kernel: events of one layer go to the other, until both are quiet.
#pragma once

#include <utility>

#include "core/time.hpp"
#include "peis/kernel/kernel_layers.hpp"

namespace rubicon::peis {

/// Each function of a kernel makes one, calls the layers and perform() for their events, and
/// returns what finish() collects. What a turn that does not finish has left is in the outputs of
/// the next that does.
class kernel_turn {
public:
  /// @param layers outlives this
  kernel_turn(kernel_layers& layers, instant now) : layers_(layers), now_(now) {}

  /// Carries out what the tuple space asks for.
  void perform(tuple_events todo);

  /// Sends a question to another owner, or reports why there is none.
  void ask(std::pair<cause, transmit> question, request_id request);

  /// How a request ended; nothing for no_request.
  void report(request_id request, cause why);
  void refuse(request_id request, cause why); ///< is counted

  /// Sets own tuples.
  void publish(const kernel_statistics::texts& values);
  /// Recomputes kernel.* tuples of this pattern if they are out of date and not watched; so it
  /// sends nothing (TUP-14).
  void refresh_statistics(const key& pattern);

  /// Input of links waits until finish_with_input() is called.
  [[nodiscard]] outputs finish() { return finish(false); }
  /// Handles the input of this turn as well, and all that comes of it.
  [[nodiscard]] outputs finish_with_input() { return finish(true); }

private:
  outputs finish(bool input);
  void settle();
  bool handle_events();
  /// What the network reports that only the owner can act on.
  template <class T>
  void handle(T& x) {
    layers_.out.emplace_back(std::move(x));
  }
  void handle(host_appeared& x);
  void handle(id_taken& x);
  void handle(host_vanished& x);
  void handle(forgotten_by& x);
  void handle(arrived& x);
  void handle(delivered& x);
  void handle(device_noted& x);
  void handle(undelivered& x);
  void dispatch(arrived& x);
  void on_set(peer_id source, const payload& octets);
  [[nodiscard]] bool may_stop_us(peer_id source) const;
  void perform(transmit& x);
  void perform(transmit_all& x);
  void perform(tuple_changed& x);
  void perform(tuple_deleted& x);

  kernel_layers& layers_;
  instant now_;
  work_units events_made_ = 0; ///< by the tuple space, for the message that is handled
};

} // namespace rubicon::peis
