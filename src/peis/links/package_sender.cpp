#include "peis/links/package_sender.hpp"

#include <cstddef>
#include <utility>
#include <vector>

#include "core/account/message_ledger.hpp"

namespace rubicon::peis {

namespace {

constexpr std::size_t octets_per_work = 512; // copied for each link that a package goes to

std::shared_ptr<const message_octets> content_of(payload octets) {
  return std::make_shared<const message_octets>(message_octets{std::move(octets), {}});
}

} // namespace

cause package_sender::enqueue(connection& to, lane where, outgoing_package x, link_id origin) {
  auto& queue = to.out.queue;
  const auto verdict = queue.admission(where, 1, header_size + x.length(), origin, own_.rng);
  if (verdict == cause::none)
    queue.push(where, std::move(x), origin);
  return verdict;
}

void package_sender::send(connection& to, lane where, outgoing_package x, link_id origin) {
  count_drop(enqueue(to, where, std::move(x), origin));
}

void package_sender::send_to_neighbour(connection& to, std::uint16_t port, bytes data,
                                       link_id origin) {
  auto content = content_of(std::move(data));
  const auto header = own_.fresh_header(package_type::link, port);
  send(to, lane::control, {header, std::move(content), 0}, origin);
}

void package_sender::send_to_host(peer_id to, link_id hop, lane where, std::uint16_t port,
                                  bytes data, link_id origin) {
  auto content = content_of(std::move(data));
  auto header = own_.fresh_header(package_type::direct, port);
  header.destination = to;
  send(links_.at(hop), where, {header, std::move(content), 0}, origin);
}

/// Services of the kernel go before those of users.
cause package_sender::flood(const package_header& header,
                            const std::shared_ptr<const message_octets>& content,
                            std::optional<link_id> except, link_id origin) {
  const auto where = header.port < port::user_first ? lane::high : lane::normal;
  const auto fanout = own_.config.broadcast_fanout;
  std::vector<connection*> chosen;
  std::vector<connection*> others;
  for (auto& [link, x] : links_.all()) {
    if (x.open && link != except)
      (fanout == 0 || x.always() ? chosen : others).push_back(&x);
  }
  for (unsigned i = 0; i < fanout && !others.empty(); ++i) {
    const auto lot = others.begin() + static_cast<std::ptrdiff_t>(own_.rng.below(others.size()));
    chosen.push_back(*lot);
    others.erase(lot);
  }
  own_.work.add(chosen.size() * (1 + content->size() / octets_per_work));
  cause worst = cause::none;
  for (auto* x : chosen) {
    const auto verdict = enqueue(*x, where, {header, content, 0}, origin);
    count_drop(verdict);
    worst = verdict == cause::none ? worst : verdict;
  }
  return worst;
}

cause package_sender::broadcast(std::uint16_t port, payload octets, link_id origin) {
  if (octets.size() > data_max)
    return cause::too_long;
  if (own_.left)
    return cause::left;
  auto content = content_of(std::move(octets));
  return flood(own_.fresh_header(package_type::broadcast, port), content, {}, origin);
}

void package_sender::count_drop(cause why) {
  if (why != cause::none)
    rubicon::note_loss(why == cause::no_route ? loss::gateway_stopped : loss::package_lost);
  if (why == cause::queue_full)
    ++own_.counters.queue_full;
  else if (why == cause::early_drop)
    ++own_.counters.early_drop;
}

} // namespace rubicon::peis
