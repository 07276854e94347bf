#include "peis/reassembly.hpp"

#include <algorithm>
#include <utility>

namespace rubicon::peis {

reassembly::group reassembly::group_of(const package_header& header) {
  return {header.source, header.seqid, header.port};
}

/// By how much the fragment would lengthen what is held.
std::size_t reassembly::growth(const partial* x, const package_header& header) {
  const auto end = header.seqnum * data_max + header.length;
  const auto have = x != nullptr ? x->octets.size() : 0;
  return end > have ? end - have : 0;
}

bool reassembly::accepts(const package_header& header) const {
  const auto known = messages_.find(group_of(header));
  if (known == messages_.end())
    return messages_.size() < config_.messages_max &&
           octets_ + growth(nullptr, header) <= config_.octets_max;
  return known->second.fragments == header.seqlen &&
         octets_ + growth(&known->second, header) <= config_.octets_max;
}

std::optional<bytes> reassembly::add(const package_header& header, byte_view data, instant now) {
  const auto at = messages_.try_emplace(group_of(header)).first;
  auto& x = at->second;
  if (x.fragments == 0) {
    x.fragments = x.missing = header.seqlen;
    x.have.resize(header.seqlen);
  }
  x.last = now;
  if (!next_check_)
    next_check_ = now + config_.timeout;
  if (x.have[header.seqnum])
    return std::nullopt;
  x.have[header.seqnum] = true;
  --x.missing;
  const auto offset = header.seqnum * data_max;
  octets_ += growth(&x, header);
  if (x.octets.size() < offset + data.size())
    x.octets.resize(offset + data.size());
  std::copy(data.begin(), data.end(), x.octets.begin() + static_cast<std::ptrdiff_t>(offset));
  if (x.missing > 0)
    return std::nullopt;
  octets_ -= x.octets.size();
  auto whole = std::move(x.octets);
  messages_.erase(at);
  if (messages_.empty())
    next_check_.reset();
  return whole;
}

std::map<reassembly::group, reassembly::partial>::iterator
reassembly::erase(std::map<group, partial>::iterator at) {
  octets_ -= at->second.octets.size();
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
