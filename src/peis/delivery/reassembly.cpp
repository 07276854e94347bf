#include "peis/delivery/reassembly.hpp"

#include <algorithm>
#include <utility>

namespace rubicon::peis {

reassembly::group reassembly::group_of(const package_header& header) {
  return {header.source, header.seqid, header.port};
}

/// Memory for all that has come and this fragment: twice as much as before when it must grow, but
/// no more than the whole takes.
std::size_t reassembly::capacity_for(const partial* x, const package_header& header) {
  const auto end = header.seqnum * data_max + header.length;
  const auto have = x != nullptr ? x->octets.capacity() : 0;
  return end <= have ? have : std::max(end, std::min(2 * have, header.seqlen * data_max));
}

std::size_t reassembly::growth(const partial* x, const package_header& header) {
  return capacity_for(x, header) - (x != nullptr ? x->octets.capacity() : 0);
}

std::size_t reassembly::room() const {
  const auto here = config_.octets_max - std::min(config_.octets_max, octets_);
  return memory_ ? std::min(here, memory_->free()) : here;
}

bool reassembly::accepts(const package_header& header, link_id over) const {
  const auto known = messages_.find(group_of(header));
  const bool is_new = known == messages_.end();
  if (!is_new && known->second.fragments != header.seqlen)
    return false;
  const auto added = growth(is_new ? nullptr : &known->second, header);
  if (!is_new && added == 0)
    return true;
  const auto found = shares_.find(is_new ? over : known->second.over);
  const auto held = found == shares_.end() ? share{} : found->second;
  const bool has_slot = messages_.size() < config_.messages_max &&
                        held.messages < config_.messages_max - messages_.size();
  const bool has_memory = held.octets + 2 * added <= room();
  return (!is_new || has_slot) && has_memory;
}

std::optional<bytes> reassembly::add(const package_header& header, byte_view data, instant now,
                                     link_id over) {
  const auto at = messages_.try_emplace(group_of(header)).first;
  auto& x = at->second;
  if (x.fragments == 0) {
    x.fragments = x.missing = header.seqlen;
    x.have.resize(header.seqlen);
    x.over = over;
    ++shares_[over].messages;
  }
  x.last = now;
  if (!next_check_)
    next_check_ = now + config_.timeout;
  if (x.have[header.seqnum])
    return std::nullopt;
  x.have[header.seqnum] = true;
  --x.missing;
  const auto offset = header.seqnum * data_max;
  const auto before = x.octets.capacity();
  x.octets.reserve(capacity_for(&x, header));
  const auto added = x.octets.capacity() - before;
  octets_ += added;
  shares_[x.over].octets += added;
  if (memory_)
    memory_->reserve(added);
  if (x.octets.size() < offset + data.size())
    x.octets.resize(offset + data.size());
  std::copy(data.begin(), data.end(), x.octets.begin() + static_cast<std::ptrdiff_t>(offset));
  if (x.missing > 0)
    return std::nullopt;
  release(x);
  auto whole = std::move(x.octets);
  messages_.erase(at);
  if (messages_.empty())
    next_check_.reset();
  return whole;
}

/// Its memory is no longer ours.
void reassembly::release(const partial& x) {
  octets_ -= x.octets.capacity();
  if (memory_)
    memory_->release(x.octets.capacity());
  const auto from = shares_.find(x.over);
  from->second.octets -= x.octets.capacity();
  if (--from->second.messages == 0)
    shares_.erase(from);
}

std::map<reassembly::group, reassembly::partial>::iterator
reassembly::erase(std::map<group, partial>::iterator at) {
  release(at->second);
  return messages_.erase(at);
}

void reassembly::drop(peer_id source) {
  for (auto at = messages_.begin(); at != messages_.end();)
    at = at->first.source == source ? erase(at) : std::next(at);
  if (messages_.empty())
    next_check_.reset();
}

std::size_t reassembly::on_time(instant now) {
  if (!next_check_ || now < *next_check_)
    return 0;
  std::size_t discarded = 0;
  next_check_.reset();
  for (auto at = messages_.begin(); at != messages_.end();) {
    const auto due = at->second.last + config_.timeout;
    if (due <= now) {
      at = erase(at);
      ++discarded;
    } else {
      next_check_ = earliest(next_check_, due);
      ++at;
    }
  }
  return discarded;
}

} // namespace rubicon::peis
