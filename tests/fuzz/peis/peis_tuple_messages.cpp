// The decoders of push, set, subscribe, unsubscribe and the append messages; what decodes encodes
// to what decodes to the same again.
#include <algorithm>
#include <cassert>
#include <cstdint>

#include "peis/tuples/tuple_record.hpp"

using namespace rubicon;

namespace {

bytes joined(bytes head, const payload& body) {
  head.insert(head.end(), body.view().begin(), body.view().end());
  return head;
}

bytes whole(const peis::tuple& x) {
  return joined(peis::encode_tuple_head(x, peis::tuple_message_kind::push),
                peis::encode_tuple_value(x));
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const byte_view octets(data, size);
  if (const auto x = peis::decode_tuple_message(to_bytes(octets), {})) {
    const auto again = peis::decode_tuple_message(whole(*x), {});
    assert(again && again->name == x->name && again->value == x->value &&
           again->mimetype == x->mimetype && again->expiry == x->expiry &&
           again->written == x->written && again->seqno == x->seqno);
  }
  if (const auto x = peis::decode_subscribe(octets, {})) {
    const auto again = peis::decode_subscribe(peis::encode(*x), {});
    assert(again && again->wanted == x->wanted && again->lifetime == x->lifetime);
  }
  if (const auto x = peis::decode_unsubscribe(octets)) {
    const auto again = peis::decode_unsubscribe(peis::encode_unsubscribe(*x));
    assert(again && again->owner == x->owner && again->name == x->name);
  }
  if (const auto x = peis::decode_append_request(to_bytes(octets), {})) {
    const auto again =
        peis::decode_append_request(joined(peis::encode_append_request_head(*x), x->added), {});
    assert(again && again->wanted == x->wanted && again->added == x->added);
  }
  if (const auto x = peis::decode_append_notice(to_bytes(octets))) {
    peis::tuple before;
    before.owner = x->owner;
    before.name = x->name;
    before.seqno = x->seqno;
    before.append_seqno = x->append_seqno;
    const auto again = peis::decode_append_notice(
        joined(peis::encode_append_notice_head(before, x->added.size()), x->added));
    assert(again && again->name == x->name && again->added == x->added &&
           again->seqno == x->seqno && again->append_seqno == x->append_seqno);
  }
  return 0;
}
