// Kernels joined by links under virtual time: each link delays, may be cut, and may lose packages.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/numbers/random.hpp"
#include "peis/kernel/kernel.hpp"
#include "peis/link/link.hpp"

namespace rubicon::peis::test {

/// A package that a link has carried, or lost.
struct carried {
  instant at;
  peer_id from;
  package_header header;
  bool lost = false;
};

class world {
public:
  explicit world(std::uint64_t seed = 1) : seed_(seed) {}
  world(const world&) = delete;
  world& operator=(const world&) = delete;

  /// Adds a peer with its own host name. @returns its id
  peer_id add(std::int32_t id);
  peer_id add(kernel_config config);

  /// Adds peers 1 to `count`, each with a link to the next, that open no others.
  void add_line(int count);

  /// Starts a peer again, all forgotten; its links must be cut before.
  void restart(peer_id id);

  /// Ends a peer's process: its links are closed, as an operating system does.
  void kill(peer_id id);

  /// Nothing that this peer sends, and nothing sent to it, arrives any more; nobody is told.
  void power_off(peer_id id);

  /// Can octets, announcements and attempts pass between these two? They can if it is empty.
  std::function<bool(peer_id, peer_id)> separated;

  /// Nobody listens at these addresses (any more); attempts there fail.
  std::set<std::string> vacant;

  /// What a peer is started with next.
  kernel_config& config(peer_id id) { return peers_.at(id).config; }

  [[nodiscard]] bool alive(peer_id id) const { return peers_.at(id).alive; }
  [[nodiscard]] bool paused(peer_id id) const { return peers_.at(id).paused; }
  [[nodiscard]] std::vector<peer_id> peers() const;

  kernel& at(peer_id id) { return peers_.at(id).kernel; }

  /// Opens a link. @returns its number
  link_id connect(peer_id a, peer_id b, duration delay = 1ms);
  void cut(link_id link);

  /// Decides about each package; those it does not keep are lost.
  std::function<bool(const package_header&)> keep;

  /// This peer answers passing questions about a host with this record for ever, as a real kernel
  /// does with one that it has.
  void remember(peer_id relay, const host_record& record) { memories_[relay][record.id] = record; }

  /// Peers whose records reach others without the mark: they are taken for real kernels. What only
  /// marked peers say to each other, they do not say.
  std::set<peer_id> unmarked;

  /// What meets a cut is not lost, but sent again after 0.2, 0.4, 0.8 s and so on, what follows
  /// behind it, as by TCP. A link that was closed meanwhile ends for the other side then.
  bool tcp = false;

  /// Links over which nothing passes any more, though nobody has closed them.
  std::set<link_id> stuck;

  /// A process that stands still: what comes for it waits.
  void pause(peer_id id);
  void resume(peer_id id);

  /// Of all links, each way; 0: what is written is there after the delay.
  double octets_per_second = 0;

  /// When false, links report nothing as sent: windows fill up.
  bool drains = true;

  void run_for(duration length);
  [[nodiscard]] instant now() const { return now_; }

  /// Carries out what a command has returned.
  void perform(peer_id id, outputs todo);

  /// All outputs of one kind that a peer has made.
  template <class T>
  [[nodiscard]] std::vector<T> all(peer_id id) const {
    std::vector<T> found;
    for (const auto& [when, x] : peers_.at(id).log) {
      if (const auto* match = std::get_if<T>(&x))
        found.push_back(*match);
    }
    return found;
  }

  [[nodiscard]] std::size_t wakeups(peer_id id) const { return peers_.at(id).wakeups; }
  void clear_logs();

  std::vector<carried> packages; ///< everything that any link carried, in order

private:
  struct peer {
    kernel_config config;
    rubicon::peis::kernel kernel;
    std::vector<std::pair<instant, output>> log;
    std::size_t wakeups = 0;
    std::uint64_t lives = 0;
    bool alive = true;
    bool paused = false;
    std::deque<std::function<void()>> missed; ///< while paused
    std::optional<instant> due;               ///< its entry in due_
  };
  struct direction {
    stream_decoder decoder;
    bool request_due = false;
    instant busy;                                   ///< until then with what was written before
    std::deque<std::pair<bytes, std::size_t>> held; ///< behind a cut; with what was written of it
    duration wait{};                                ///< before it is sent again
  };
  struct joint {
    peer_id a;
    peer_id b;
    duration delay;
    direction from_a;
    direction from_b;
    std::optional<peer_id> closed_by; ///< the other end has not learnt of it
  };
  void start(peer& x);
  link_id open(peer_id a, peer_id b, duration delay, std::optional<attempt_id> attempt);
  void carry(peer_id from, const to_link& x);
  bool answer_from_memory(peer_id relay, peer_id asker, link_id link, const package_header& header,
                          byte_view data);
  void answer(peer_id from, const connect_to& x);
  void spread(peer_id from, const announce& x);
  void later(std::function<void()> what, duration delay);
  void tell(peer_id id, std::function<void()> what);
  void close(peer_id by, link_id link);
  void arrive(link_id link, bool from_a, bytes octets, std::size_t written);
  void send_again(link_id link, bool from_a);
  void deliver(link_id link, peer_id to, const bytes& octets);
  [[nodiscard]] bool joined(peer_id a, peer_id b) const;
  void note_deadline(peer_id id);

  std::uint64_t seed_;
  instant now_{};
  std::map<peer_id, peer> peers_;
  std::map<link_id, joint> cables_;
  std::uint64_t next_link_ = 1;
  std::map<peer_id, std::map<peer_id, host_record>> memories_; ///< by relay, by host
  std::int32_t next_package_ = 0x70000000;
  std::multimap<instant, std::function<void()>> in_flight_;
  std::set<std::pair<instant, peer_id>> due_; ///< deadlines of those alive
};

[[nodiscard]] kernel_config config_of(std::int32_t id);

/// A peer that others can find and connect to.
[[nodiscard]] kernel_config lan_config_of(std::int32_t id);

} // namespace rubicon::peis::test
