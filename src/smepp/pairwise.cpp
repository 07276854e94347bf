#include "smepp/pairwise.hpp"

#include <algorithm>

#include "core/codec.hpp"

namespace rubicon::smepp {

namespace {

/// All that a relay has no business to change: not the hops.
tag proof_of(const key& under, const event& x, group_id group) {
  byte_writer input;
  input.big(group.value)
      .big(x.id.subscriber.value)
      .octet(x.id.number)
      .big(x.producer.value)
      .big(x.sequence)
      .append(x.value);
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
  keys_[other] = x;
  return true;
}

std::optional<tag> pairwise_keys::prove(const event& x, group_id group) const {
  const auto found = keys_.find(x.id.subscriber);
  if (found == keys_.end())
    return std::nullopt;
  return proof_of(found->second, x, group);
}

bool pairwise_keys::is_proven(const event& x, group_id group) const {
  const auto found = keys_.find(x.producer);
  return x.proof && found != keys_.end() && is_same(*x.proof, proof_of(found->second, x, group));
}

} // namespace rubicon::smepp
