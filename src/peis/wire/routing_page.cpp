#include "peis/wire/routing_page.hpp"

#include <algorithm>

#include "core/codec.hpp"

namespace rubicon::peis {

bytes encode(const routing_page& page) {
  byte_writer to;
  to.big(page.page).big(page.pages).big(static_cast<std::uint16_t>(page.entries.size())).zeros(2);
  to.big(page.seqno);
  for (const auto& x : page.entries)
    to.big(x.id.value).big(x.seqno).big(x.magic).octet(x.hops).octet(x.connections);
  return to.finish();
}

result<routing_page> decode_routing_page(byte_view octets) {
  byte_reader from(octets);
  routing_page page;
  page.page = from.big<std::uint16_t>();
  page.pages = from.big<std::uint16_t>();
  const std::size_t count = from.big<std::uint16_t>();
  from.skip(2);
  page.seqno = from.big<std::int32_t>();
  if (!from.ok())
    return errc::truncated;
  if (count > entries_per_page)
    return errc::too_long;
  const bool last = page.page + 1 == page.pages;
  if (page.pages > routing_pages_max || page.page >= page.pages ||
      (!last && count != entries_per_page))
    return errc::bad_value;
  page.entries.resize(count);
  for (auto& x : page.entries) {
    x.id = peer_id{from.big<std::int32_t>()};
    x.seqno = from.big<std::int32_t>();
    x.magic = from.big<std::int32_t>();
    x.hops = from.octet();
    x.connections = from.octet();
  }
  if (!from.ok())
    return errc::truncated;
  return page;
}

std::vector<routing_page> paginate(std::span<const routing_entry> entries, std::int32_t seqno) {
  const auto needed = (entries.size() + entries_per_page - 1) / entries_per_page;
  const auto count = std::clamp<std::size_t>(needed, 1, routing_pages_max);
  std::vector<routing_page> pages(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto rest = entries.subspan(std::min(entries.size(), i * entries_per_page));
    const auto shown = rest.first(std::min(rest.size(), entries_per_page));
    pages[i] = {static_cast<std::uint16_t>(i),
                static_cast<std::uint16_t>(count),
                seqno,
                {shown.begin(), shown.end()}};
  }
  return pages;
}

} // namespace rubicon::peis
