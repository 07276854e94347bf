// Two PEIS kernels in one thread and virtual time, for benches of what kernels do.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <utility>
#include <variant>

#include "calibration.hpp"
#include "core/numbers/random.hpp"
#include "peis/kernel/kernel.hpp"

namespace bench {

/// Two kernels joined by a link that takes no time and loses nothing; tells the longest turn.
class kernel_pair {
public:
  kernel_pair() {
    for (int i = 0; i < 2; ++i) {
      rubicon::peis::kernel_config x;
      x.network.id = rubicon::peer_id{i + 1};
      x.network.host_name = "bench";
      x.network.connections.announces = false;
      x.tuples.held_octets_max = std::size_t{4} << 30U; // all of 1 000 000, from one owner
      x.tuples.others_octets_max = x.tuples.held_octets_max;
      kernels_[static_cast<std::size_t>(i)] =
          rubicon::peis::kernel(x, rubicon::random_stream(static_cast<std::uint64_t>(i + 1)), now_);
    }
    perform(1, kernels_[1].on_link_open(link, rubicon::peis::link_role::acceptor, now_));
    perform(0, kernels_[0].on_link_open(link, rubicon::peis::link_role::initiator, now_));
    pass(std::chrono::seconds(5));
    turn_max_s = 0;
  }

  void pass(rubicon::duration time) {
    for (const auto end = now_ + time; now_ < end; now_ += std::chrono::milliseconds(1))
      step();
  }

  /// @returns false if it takes longer than that much CPU
  template <class Condition>
  bool pass_until(Condition done, double cpu_limit_s) {
    for (const auto end = cpu_s() + cpu_limit_s; !done(); now_ += std::chrono::milliseconds(1)) {
      if (cpu_s() > end)
        return false;
      step();
    }
    return true;
  }

  template <class Command>
  void command(std::size_t who, Command what) {
    perform(who, what(kernels_[who], now_));
  }

  rubicon::peis::kernel& at(std::size_t who) { return kernels_[who]; }

  double turn_max_s = 0;

private:
  static constexpr rubicon::peis::link_id link{1};

  void step() {
    for (int i = 0; i < 10000 && !wire_.empty(); ++i) {
      const auto [to, octets] = wire_.front();
      wire_.pop_front();
      const auto begun = cpu_s();
      auto out = kernels_[to].on_link_octets(link, octets.view(), now_);
      turn_max_s = std::max(turn_max_s, cpu_s() - begun);
      perform(to, std::move(out));
    }
    for (std::size_t i = 0; i < 2; ++i) {
      if (const auto due = kernels_[i].deadline(); due && *due <= now_) {
        const auto begun = cpu_s();
        auto out = kernels_[i].on_time(now_);
        turn_max_s = std::max(turn_max_s, cpu_s() - begun);
        perform(i, std::move(out));
      }
    }
  }

  void perform(std::size_t who, rubicon::peis::outputs todo) {
    for (auto& x : todo) {
      if (auto* sent = std::get_if<rubicon::peis::to_link>(&x))
        wire_.emplace_back(1 - who, std::move(sent->octets));
    }
  }

  rubicon::instant now_{};
  std::array<rubicon::peis::kernel, 2> kernels_;
  std::deque<std::pair<std::size_t, rubicon::payload>>
      wire_; ///< with the number of whom they go to
};

} // namespace bench
