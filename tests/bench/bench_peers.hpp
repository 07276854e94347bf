// Processes of peis_bench_peer (its line protocol is told there) for a bench that drives them.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <sys/types.h>

namespace bench {

/// `@ <seconds> NAME words`, the time on wall_s()'s clock.
struct event {
  double at_s = 0;
  std::string name;
  std::vector<std::string> words;

  /// Of the word after `label`; not a number if there is none.
  [[nodiscard]] double number(std::string_view label) const;
};

/// One peer, on loopback only. Destroying it kills it. If this program ends without that, it finds
/// its input at an end and leaves by itself.
class bench_peer {
public:
  /// @param connect where it always wants a link, as URL; empty: nowhere
  /// @throws std::system_error if it cannot be started
  bench_peer(int id, const std::string& network, const std::string& connect);
  ~bench_peer();
  bench_peer(const bench_peer&) = delete;
  bench_peer& operator=(const bench_peer&) = delete;

  [[nodiscard]] int id() const { return id_; }
  [[nodiscard]] pid_t pid() const { return pid_; }
  [[nodiscard]] int output() const { return from_; } ///< -1 once it has ended
  [[nodiscard]] const std::vector<event>& heard() const { return heard_; }

  /// The first with that name, of those after the first `from`; nullptr: none.
  [[nodiscard]] const event* find(std::string_view name, std::size_t from = 0) const;
  /// Since when it knows `count` peers, itself included, and reaches all others; nullptr: not yet.
  [[nodiscard]] const event* complete(int count) const;

  void send(const std::string& line); ///< a command
  void read();                        ///< takes what is there; never waits
  void kill();

  [[nodiscard]] double processor_s() const;                     ///< used so far
  [[nodiscard]] double memory_kib(std::string_view what) const; ///< "Rss:" or "Pss:"

private:
  void take(const std::string& line);

  int id_;
  pid_t pid_ = -1;
  int to_ = -1;
  int from_ = -1;
  std::string line_;
  std::vector<event> heard_;
  std::map<std::string, int> complaints_; ///< how often
};

/// Peers 100, 101, ... of one ecology that knows no other; each but the first is told of the first.
/// Destroying them ends all: those that do not leave in time are killed.
class bench_peers {
public:
  /// Starts the first, and when that listens all others at once.
  /// @throws std::runtime_error if one does not start
  explicit bench_peers(int count);
  ~bench_peers();

  [[nodiscard]] bench_peer& operator[](std::size_t i) { return *all_[i]; }
  [[nodiscard]] std::size_t size() const { return all_.size(); }
  [[nodiscard]] double started_s() const { return started_s_; } ///< the last one

  /// Listens to all of them.
  /// @returns what `done` says last
  bool wait(double timeout_s, const std::function<bool()>& done);
  void wait(double s) {
    wait(s, [] { return false; });
  }

  /// @throws std::runtime_error if that takes more than `timeout_s`
  void wait_complete(double timeout_s);

  /// Sends a command and waits for its answer.
  /// @throws std::runtime_error if none has come after `timeout_s`
  event ask(bench_peer& whom, const std::string& command, std::string_view answer,
            double timeout_s);

private:
  std::vector<std::unique_ptr<bench_peer>> all_;
  double started_s_ = 0;
};

} // namespace bench
