#include "smepp/crypto/pairwise.hpp"

#include <algorithm>

#include "core/codec.hpp"

namespace rubicon::smepp {

namespace {

/// All that a relay has no business to change: not the hops.
tag proof_of(const key& under, const event& x, group_id group, group_time made_at,
             std::uint64_t number) {
  byte_writer input;
  input.big(group.value).big(x.id.subscriber.value).octet(x.id.number);
  write(input, made_at);
  input.big(x.producer.value).big(x.sequence).big(number).append(x.value);
  return short_mac(under, input.view());
}

} // namespace

key pairwise_key(const key& root, mote_id a, mote_id b) {
  byte_writer pair;
  pair.big(std::min(a, b).value).big(std::max(a, b).value);
  return derive(root, "pair", pair.view());
}

bool pairwise_keys::set(mote_id other, const key& x) {
  if (!keys_.contains(other) && keys_.size() >= capacity_)
    return false;
  keys_[other].under = x;
  return true;
}

std::optional<sender_proof> pairwise_keys::prove(const event& x, group_id group, group_time made_at,
                                                 std::uint64_t number) const {
  const auto found = keys_.find(x.id.subscriber);
  if (found == keys_.end())
    return std::nullopt;
  return sender_proof{number, proof_of(found->second.under, x, group, made_at, number)};
}

bool pairwise_keys::is_proven(const event& x, group_id group, group_time made_at) const {
  const auto found = keys_.find(x.producer);
  return x.proof && found != keys_.end() &&
         is_same(x.proof->mac, proof_of(found->second.under, x, group, made_at, x.proof->number));
}

bool pairwise_keys::take(const event& x) {
  constexpr std::uint64_t width = 32;
  auto& from = keys_.at(x.producer);
  const auto number = x.proof->number;
  if (from.seen == 0 || number > from.highest) {
    const auto step = from.seen == 0 ? width : number - from.highest;
    from.seen = (step < width ? from.seen << step : 0) | 1;
    from.highest = number;
    return true;
  }
  const auto behind = from.highest - number;
  if (behind >= width || (from.seen >> behind & 1) != 0)
    return false;
  from.seen |= std::uint32_t{1} << behind;
  return true;
}

} // namespace rubicon::smepp
