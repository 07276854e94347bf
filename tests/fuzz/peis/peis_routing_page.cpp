// The decoders of what peers tell about hosts: routing pages, records, queries, dead hosts,
// acknowledgements. What decodes encodes back to the same meaning.
#include <cassert>
#include <cstdint>

#include "peis/overlay/routing_table.hpp"
#include "peis/wire/acknowledgement.hpp"
#include "peis/wire/dead_host.hpp"
#include "peis/wire/host_query.hpp"
#include "peis/wire/host_record.hpp"
#include "peis/wire/routing_page.hpp"

using namespace rubicon;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const byte_view octets(data, size);
  if (const auto x = peis::decode_routing_page(octets)) {
    assert(*peis::decode_routing_page(peis::encode(*x)) == *x);
    peis::routing_table routes(peer_id{10}, 1, 30);
    static_cast<void>(routes.on_table(peis::link_id{1}, 2, x->entries, instant{}));
    static_cast<void>(routes.on_link_closed(peis::link_id{1}, instant{}));
  }
  if (const auto x = peis::decode_host_record_message(octets)) {
    const auto again = peis::decode_host_record_message(peis::encode(*x));
    assert(again && again->record == x->record && again->cached == x->cached);
  }
  if (const auto x = peis::decode_host_query(octets))
    assert(peis::decode_host_query(peis::encode(*x))->magic == x->magic);
  if (const auto x = peis::decode_dead_host(octets))
    assert(peis::decode_dead_host(peis::encode(*x))->host == x->host);
  if (const auto x = peis::decode_acknowledgement(octets))
    assert(*peis::decode_acknowledgement(peis::encode_acknowledgement(*x)) == *x);
  return 0;
}
