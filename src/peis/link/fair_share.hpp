// Memory that many hosts share without any of them taking it all.
#pragma once

#include <algorithm>
#include <cstddef>
#include <map>
#include <memory>
#include <utility>

#include "core/address.hpp"

namespace rubicon::peis {

/// Counts what each host takes of a limit. A host may have up to `share_factor` times of what is
/// then still free (dynamic thresholds, Choudhury and Hahne 1998): one alone gets four fifths of
/// the limit, sixty-four that take what they can leave 1/257 of it, which a newcomer may have.
/// Several tables may have a pool in common: what one of them takes, the others cannot.
class fair_share {
public:
  static constexpr std::size_t share_factor = 4;

  explicit fair_share(std::size_t limit = 0, std::shared_ptr<fair_share> pool = nullptr)
      : limit_(limit), pool_(std::move(pool)) {}

  /// May this host take so much more?
  [[nodiscard]] bool admits(peer_id host, std::size_t more) const {
    if (more > limit_ || total_ > limit_ - more)
      return false;
    if (pool_ && !pool_->admits(host, more))
      return false;
    return of(host) + more <= share_factor * (limit_ - total_ - more);
  }

  void add(peer_id host, std::size_t amount) {
    total_ += amount;
    shares_[host] += amount;
    if (pool_)
      pool_->add(host, amount);
  }

  /// @pre the host has taken as much
  void remove(peer_id host, std::size_t amount) {
    const auto at = shares_.find(host);
    total_ -= amount;
    at->second -= amount;
    if (at->second == 0)
      shares_.erase(at);
    if (pool_)
      pool_->remove(host, amount);
  }

  /// Takes it for what has no known host: no host's share, but of the limit.
  void reserve(std::size_t amount) {
    total_ += amount;
    if (pool_)
      pool_->reserve(amount);
  }

  /// @pre as much is reserved
  void release(std::size_t amount) {
    total_ -= amount;
    if (pool_)
      pool_->release(amount);
  }

  /// What of the limit is free.
  [[nodiscard]] std::size_t free() const {
    const auto here = limit_ - std::min(limit_, total_);
    return pool_ ? std::min(here, pool_->free()) : here;
  }

  [[nodiscard]] std::size_t of(peer_id host) const {
    const auto at = shares_.find(host);
    return at == shares_.end() ? 0 : at->second;
  }
  [[nodiscard]] std::size_t total() const { return total_; }

private:
  std::size_t limit_;
  std::size_t total_ = 0;
  std::map<peer_id, std::size_t> shares_; ///< no host without any
  std::shared_ptr<fair_share> pool_;
};

} // namespace rubicon::peis
