#include "peer/bluetooth_hellos.hpp"

#include <utility>

#include "peis/wire/announcement.hpp"

namespace rubicon::peer {

namespace {

void ignore_sent(std::size_t /*octets*/) {}

} // namespace

bluetooth_hellos::bluetooth_hellos(io::loop& where, io::bluetooth_adapter& adapter,
                                   bluetooth_hellos_config config, adapter_user& user)
    : loop_(&where), adapter_(&adapter), config_(std::move(config)), user_(&user) {}

void bluetooth_hellos::listen() {
  auto x = adapter_->listen(peis::hello_port);
  if (auto* socket = std::get_if<io::descriptor>(&x)) // else another peer announces (BT-03)
    listener_.emplace(*loop_, std::move(*socket),
                      [this](io::descriptor y) { on_connection(std::move(y)); });
}

void bluetooth_hellos::close() {
  listener_.reset();
  arrived_.clear();
  sent_.clear();
}

void bluetooth_hellos::on_connection(io::descriptor x) {
  if (arrived_.size() >= hellos_max) {
    ++lost_; // dropped
    return;
  }
  const auto number = next_++;
  auto& hello = arrived_.try_emplace(number, *loop_).first->second;
  hello.stream = io::packet_stream(*loop_, std::move(x), room);
  hello.stream.start({[this, number](byte_view octets) { on_question(number, octets); },
                      ignore_sent, [this, number](const std::string&) { arrived_.erase(number); }});
  hello.patience.start(config_.answer_timeout, [this, number] { arrived_.erase(number); });
}

void bluetooth_hellos::on_question(std::uint64_t number, byte_view octets) {
  auto& hello = arrived_.at(number);
  if (!peis::decode_announcement(octets))
    arrived_.erase(number); // dropped
  else if (!std::exchange(hello.taken, true))
    user_->on_hello(number, octets);
}

/// The other side closes the connection when it has the answer.
void bluetooth_hellos::answer(std::uint64_t number, bytes octets) {
  const auto found = arrived_.find(number);
  if (found != arrived_.end())
    static_cast<void>(found->second.stream.send(std::move(octets))); // its queue is empty
}

void bluetooth_hellos::say(const peis::say_hello& x) {
  if (sent_.contains(x.to))
    return;
  auto& hello = sent_.try_emplace(x.to, *loop_).first->second;
  const auto give_up = [this, to = x.to] { end(to, {}); };
  hello.patience.start(config_.connect_timeout + config_.answer_timeout, give_up);
  if (sent_.size() > hellos_max) {
    ++lost_;
    hello.patience.start(0s, give_up);
    return;
  }
  auto socket = adapter_->connect(x.to.octets, peis::hello_port);
  if (!std::holds_alternative<io::descriptor>(socket)) {
    hello.patience.start(0s, give_up);
    return;
  }
  hello.attempt.emplace(*loop_, std::move(std::get<io::descriptor>(socket)),
                        config_.connect_timeout,
                        [this, to = x.to, octets = to_bytes(x.octets.view())](auto y) {
                          if (auto* connected = std::get_if<io::descriptor>(&y))
                            send(to, octets, std::move(*connected));
                          else
                            end(to, {});
                        });
}

void bluetooth_hellos::send(const peis::bluetooth_address& to, const bytes& octets,
                            io::descriptor connected) {
  auto& stream = sent_.at(to).stream;
  stream = io::packet_stream(*loop_, std::move(connected), room);
  stream.start({[this, to](byte_view answer) { end(to, answer); }, ignore_sent,
                [this, to](const std::string&) { end(to, {}); }});
  static_cast<void>(stream.send(octets)); // its queue is empty
}

void bluetooth_hellos::end(const peis::bluetooth_address& to, byte_view answer) {
  const auto ended = sent_.extract(to); // lives until this call is over
  user_->on_hello_answer(config_.adapter, to, answer);
}

} // namespace rubicon::peer
