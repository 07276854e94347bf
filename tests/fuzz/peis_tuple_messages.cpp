// The decoders of push, set, subscribe and unsubscribe; what decodes encodes to what decodes to the
// same again.
#include <algorithm>
#include <cassert>
#include <cstdint>

#include "peis/tuple_record.hpp"

using namespace rubicon;

namespace {

bytes whole(const peis::tuple& x) {
  auto octets = peis::encode_tuple_head(x, peis::tuple_message_kind::push);
  const auto value = peis::encode_tuple_value(x);
  octets.insert(octets.end(), value.view().begin(), value.view().end());
  return octets;
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const byte_view octets(data, size);
  if (const auto x = peis::decode_tuple_message(to_bytes(octets))) {
    const auto again = peis::decode_tuple_message(whole(*x));
    assert(again && again->name == x->name && again->value == x->value &&
           again->mimetype == x->mimetype && again->expiry == x->expiry &&
           again->written == x->written && again->seqno == x->seqno);
  }
  if (const auto x = peis::decode_subscribe(octets)) {
    const auto again = peis::decode_subscribe(peis::encode(*x));
    assert(again && again->wanted == x->wanted && again->lifetime == x->lifetime);
  }
  if (const auto x = peis::decode_unsubscribe(octets)) {
    const auto again = peis::decode_unsubscribe(peis::encode_unsubscribe(*x));
    assert(again && again->owner == x->owner && again->name == x->name);
  }
  return 0;
}
