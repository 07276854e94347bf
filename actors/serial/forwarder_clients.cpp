#include "actors/serial/forwarder_clients.hpp"

#include <algorithm>
#include <utility>

namespace rubicon {

std::variant<std::unique_ptr<forwarder_clients>, std::string>
forwarder_clients::open(io::loop& where, const std::string& address, std::uint16_t port,
                        callbacks x, std::vector<ipv4_network> networks) {
  auto out =
      std::unique_ptr<forwarder_clients>(new forwarder_clients(std::move(x), std::move(networks)));
  auto found = io::tcp_listener::open(
      where, address, port, [self = out.get()](io::tcp_stream stream, const ipv4_address& from) {
        self->accept(std::move(stream), from);
      });
  if (auto* why = std::get_if<std::string>(&found))
    return std::move(*why);
  out->listener_ = std::make_unique<io::tcp_listener>(std::get<io::tcp_listener>(std::move(found)));
  if (out->listener_->port() != port)
    return "port " + std::to_string(port) +
           " is in use: end the program that uses it, or choose another";
  return out;
}

void forwarder_clients::accept(io::tcp_stream stream, const ipv4_address& from) {
  const auto is_of = [&from](const ipv4_network& each) { return each.contains(from); };
  if (!networks_.empty() && std::ranges::none_of(networks_, is_of)) {
    ++counters_.foreign;
    return; // and so it is closed
  }
  if (clients_.size() >= clients_max) {
    ++counters_.refused;
    return;
  }
  const auto number = next_++;
  auto& x = clients_[number];
  x.stream = std::move(stream);
  x.name = x.stream.remote_address();
  x.stream.start({[this, number](byte_view octets) { on_octets(number, octets); },
                  [](std::size_t) {},
                  [this, number](const std::string&) { clients_.erase(number); }});
  x.stream.send(serial::forwarder_greeting());
}

void forwarder_clients::on_octets(std::uint64_t number, byte_view octets) {
  auto& from = clients_.at(number);
  for (auto& packet : from.decoder.on_octets(octets))
    from.packets.push_back(std::move(packet));
  if (const auto why = from.decoder.refused(); why != serial::refusal::none) {
    ++counters_.bad_input;
    to_user_.on_event("closed the connection of " + from.name + ": " + std::string(to_string(why)));
    clients_.erase(number);
    return;
  }
  // Programs close as soon as they have written: that is noticed when all of it is handed out.
  from.stream.read(from.packets.empty());
  hand_out(number, from);
}

void forwarder_clients::hand_out(std::uint64_t number, client& from) {
  if (from.under_way || from.packets.empty())
    return;
  from.under_way = true;
  auto packet = std::move(from.packets.front());
  from.packets.pop_front();
  to_user_.on_packet(number, std::move(packet));
}

void forwarder_clients::done(std::uint64_t number) {
  const auto found = clients_.find(number);
  if (found == clients_.end())
    return;
  auto& from = found->second;
  from.under_way = false;
  hand_out(number, from);
  from.stream.read(from.packets.empty());
}

void forwarder_clients::forward(byte_view packet) {
  constexpr std::size_t forwarded_max = 255;
  if (packet.empty() || packet.size() > forwarded_max)
    return;
  const payload octets(serial::encode_forwarded(packet));
  for (auto x = clients_.begin(); x != clients_.end();) {
    auto& to = x->second;
    if (!to.decoder.greeted()) {
      ++x; // it may be anybody
    } else if (to.stream.unsent() + octets.size() <= room) {
      to.stream.send(octets);
      ++x;
    } else {
      ++counters_.slow;
      to_user_.on_event("closed the connection of " + to.name + ": it does not read");
      x = clients_.erase(x);
    }
  }
}

} // namespace rubicon
