#include "gateway/island_pc.hpp"

#include <chrono>
#include <utility>

#include "core/account/provenance.hpp"

namespace rubicon::gateway {

namespace {

communication::pc_config pc_of(const gateway_config& config) {
  communication::pc_config x;
  x.self = gateway_of(config.island);
  x.incarnation = config.incarnation;
  x.ack_wait = config.ack_wait;
  x.sends_max = config.inputs_outstanding_max;
  x.awaits_clock = true;
  x.tick_period = config.tick_period;
  x.slacks = config.slacks;
  x.channels_max = config.channels_max;
  return x;
}

} // namespace

/// The program that exchanges messages between motes and tuples.
class island_pc::messages_for_tuples final : public communication::communication_events {
public:
  void receiveFrom(mote_address source, byte_view buf, std::uint8_t am_type) override {
    received.push_back({source, am_type, to_bytes(buf)});
  }
  void ackOf(std::uint32_t number, communication::status success) override {
    outcomes.push_back({number, success == communication::SUCCESS});
  }

  std::optional<communication::interface> layer;
  std::vector<transport::received> received;
  std::vector<transport::outcome> outcomes;
};

island_pc::island_pc() = default;
island_pc::island_pc(island_pc&& x) noexcept = default;
island_pc& island_pc::operator=(island_pc&& x) noexcept = default;
island_pc::~island_pc() = default;

island_pc::island_pc(const gateway_config& config, random_stream first, random_stream further)
    : island_(config.island), config_(pc_of(config)), pc_(config_, first),
      messages_(std::make_unique<messages_for_tuples>()), rng_(further),
      was_started_before_(config.incarnation > 0), clock_wait_(config.clock_wait) {
  pc_.set_line(false); // until the sink has sent
  messages_->layer = pc_.attach_for_rest(*messages_);
}

void island_pc::observe(observer x) {
  observer_ = std::move(x);
  pc_.observe(observer_);
}

std::optional<transport::ticket> island_pc::send(mote_id to, byte_view octets,
                                                 std::uint8_t am_type) {
  return messages_->layer->send_numbered({island_, to}, octets, true, am_type);
}

std::vector<transport::received> island_pc::take_received() {
  return std::exchange(messages_->received, {});
}

std::vector<transport::outcome> island_pc::take_outcomes() {
  return std::exchange(messages_->outcomes, {});
}

void island_pc::discard() {
  messages_->received.clear();
  messages_->outcomes.clear();
}

void island_pc::start(instant now) {
  clock_valid_from_ = was_started_before_ ? now + clock_wait_ : now;
}

communication::outputs island_pc::begin_term(std::uint32_t term, bool is_line_up, instant now) {
  earlier_ += communication::totals_of(above());
  earlier_.transport.reliable_failed += outstanding(); // their answers are not received any more
  earlier_.transport.failed_left += outstanding();
  earlier_pc_ += pc_.counters();
  messages_->layer.reset();
  const stopping its_messages;
  auto next = config_;
  next.incarnation = term;
  pc_ = communication::pc(next, random_stream(rng_.next()));
  pc_.observe(observer_);
  pc_.set_line(is_line_up);
  messages_->layer = pc_.attach_for_rest(*messages_);
  return pc_.start(now);
}

communication::outputs island_pc::on_clock(duration offset, instant now) {
  clock_offset_ = offset;
  return pc_.on_clock(offset, now);
}

std::optional<network::time_answer> island_pc::answer_to(const network::time_request& x,
                                                         instant now) const {
  if (!clock_offset_ || now < clock_valid_from_)
    return std::nullopt;
  const auto time =
      std::chrono::floor<std::chrono::microseconds>(now.time_since_epoch() + *clock_offset_);
  return network::time_answer{x.number, time};
}

communication::layer_totals island_pc::layer_counters() const {
  auto sum = communication::totals_of(above());
  return sum += earlier_;
}

communication::pc_counters island_pc::counters() const {
  auto sum = pc_.counters();
  return sum += earlier_pc_;
}

} // namespace rubicon::gateway
