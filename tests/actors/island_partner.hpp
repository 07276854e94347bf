// The rest of an island, for a mote or sink actor that is tested alone among fakes.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "actors/frames.hpp"
#include "actors/messages/air.hpp"
#include "support/island_fixture.hpp"
#include "testkit/fake.hpp"

namespace rubicon::test {

/// Carries frames between an actor's radio and the cores of the other motes and the sink, in steps
/// of a few milliseconds.
template <class Actor>
class island_partner {
public:
  /// @param actor of mote `self`, which is the outsider of `config`
  island_partner(fixture& world, fake<air_actor>& air, Actor& actor, mote_id self,
                 island_fixture_config config)
      : cores((config.outsider = self, config)), world_(world), air_(air), actor_(actor),
        self_(self) {
    cores.to_outsider = [this](mote_id from, const network::frame_out& x) {
      if (!only_beacons || x.am_type == network::am::beacon)
        world_.send(actor_, radio_frame(from, x.next_hop, x.am_type, x.payload));
    };
    cores.outsider_sent = [this](std::uint64_t token, bool acked, unsigned transmissions) {
      radio_done done;
      done.token = token;
      done.status = acked ? radio::send_status::sent : radio::send_status::no_ack;
      done.transmissions = transmissions;
      world_.send(actor_, done);
    };
  }

  void run_for(duration length) {
    const auto end = world_.now() + length;
    for (carry(); world_.now() < end; carry()) {
      const auto step = std::min<duration>(5ms, end - world_.now());
      cores.run_for(step);
      world_.run_for(step);
    }
  }

  template <class Done>
  bool run_until(Done done, duration limit) {
    for (const auto end = world_.now() + limit; !done() && world_.now() < end;)
      run_for(100ms);
    return done();
  }

  island_fixture cores;

  /// What the actor has had on the radio so far, except beacons.
  std::vector<radio_send> sent;
  bool only_beacons = false; ///< the actor hears nothing else

private:
  void carry() {
    for (const auto& x : air_.all<radio_send>()) {
      if (x.am_type != network::am::beacon)
        sent.push_back(x);
      network::frame_out frame{x.token, x.destination, x.am_type, to_bytes(x.octets.view()), {}};
      if (x.age_at != no_age)
        frame.age_at = x.age_at;
      cores.put_on_air(self_, std::move(frame));
    }
    air_.forget<radio_send>();
  }

  fixture& world_;
  fake<air_actor>& air_;
  Actor& actor_;
  mote_id self_;
};

} // namespace rubicon::test
