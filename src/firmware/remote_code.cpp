#include "firmware/remote_code.hpp"

#include <algorithm>
#include <exception>
#include <stdexcept>
#include <string>

#include "core/codec.hpp"

namespace rubicon::firmware {

namespace {

/// First octet of a message to the firmware.
enum class call_kind : std::uint8_t { init = 1, run, received, sent, answer };

/// First octet of a message to the host; after send, draw and read an answer follows.
enum class request_kind : std::uint8_t {
  send = 1,
  radio,
  timer,
  serial,
  draw,
  read,
  leds,
  log,
  done,
  failed
};

constexpr std::size_t text_octets_max = 1024;

template <class Kind>
byte_writer begin(Kind x) {
  byte_writer out;
  out.octet(static_cast<std::uint8_t>(x));
  return out;
}

[[noreturn]] void refuse() {
  throw std::runtime_error("the firmware's process sends what is no request");
}

/// The host, as a firmware in another process has it.
class remote_host final : public host {
public:
  explicit remote_host(message_pipe& pipe) : pipe_(pipe) {}

  firmware::answer send(byte_view frame) override {
    const auto length = std::min(frame.size(), text_octets_max); // which is no frame either
    pipe_.send(begin(request_kind::send).append(frame.first(length)).finish());
    return static_cast<firmware::answer>(answer().value_or(RUBICON_MOTE_INVALID));
  }
  void set_radio(bool on) override {
    pipe_.send(begin(request_kind::radio).octet(on ? 1 : 0).finish());
  }
  void set_timer(std::uint64_t at_us) override {
    pipe_.send(begin(request_kind::timer).little(at_us).finish());
  }
  void write_serial(byte_view octets) override {
    for (; !octets.empty(); octets = octets.subspan(std::min(octets.size(), text_octets_max)))
      pipe_.send(begin(request_kind::serial)
                     .append(octets.first(std::min(octets.size(), text_octets_max)))
                     .finish());
  }
  std::uint32_t draw() override {
    pipe_.send(begin(request_kind::draw).finish());
    return answer().value_or(0);
  }
  std::optional<std::int32_t> read(std::string_view sensor) override {
    pipe_.send(begin(request_kind::read).append(octets_of(sensor)).finish());
    const auto found = answer();
    return found ? std::optional(static_cast<std::int32_t>(*found)) : std::nullopt;
  }
  void set_leds(unsigned on) override {
    pipe_.send(begin(request_kind::leds).little(std::uint32_t{on}).finish());
  }
  void log(std::string_view line) override {
    pipe_.send(begin(request_kind::log).append(octets_of(line)).finish());
  }

private:
  static bytes octets_of(std::string_view x) { return to_bytes(x.substr(0, text_octets_max)); }

  std::optional<std::uint32_t> answer() {
    const auto message = pipe_.receive();
    byte_reader in(message);
    static_cast<void>(in.octet()); // the host sends nothing else now
    const auto is_there = in.octet() != 0;
    const auto value = in.little<std::uint32_t>();
    return is_there ? std::optional(value) : std::nullopt;
  }

  message_pipe& pipe_;
};

void perform(byte_view message, code& of, host& its) {
  byte_reader in(message);
  const auto kind = static_cast<call_kind>(in.octet());
  if (kind == call_kind::init) {
    identity who;
    who.mote = in.little<std::uint16_t>();
    who.island = in.little<std::uint16_t>();
    who.channel = in.octet();
    of.init(who, its);
    return;
  }
  const auto now = in.little<std::uint64_t>();
  if (kind == call_kind::run) {
    of.run(now);
  } else if (kind == call_kind::received) {
    const auto rssi_dbm = static_cast<std::int16_t>(in.little<std::uint16_t>());
    of.received(now, in.rest(), rssi_dbm);
  } else {
    of.sent(now, static_cast<outcome>(in.octet()));
  }
}

} // namespace

void remote_code::init(const identity& who, host& of) {
  host_ = &of;
  call(begin(call_kind::init).little(who.mote).little(who.island).octet(who.channel).finish());
}

void remote_code::run(std::uint64_t now_us) {
  call(begin(call_kind::run).little(now_us).finish());
}

void remote_code::received(std::uint64_t now_us, byte_view frame, int rssi_dbm) {
  call(begin(call_kind::received)
           .little(now_us)
           .little(static_cast<std::uint16_t>(rssi_dbm))
           .append(frame)
           .finish());
}

void remote_code::sent(std::uint64_t now_us, outcome how) {
  call(begin(call_kind::sent).little(now_us).octet(static_cast<std::uint8_t>(how)).finish());
}

void remote_code::call(const bytes& message) {
  pipe_.begin_call();
  pipe_.send(message);
  while (follow(pipe_.receive())) {
  }
}

void remote_code::answer_with(std::uint32_t value, bool is_there) {
  pipe_.send(begin(call_kind::answer).octet(is_there ? 1 : 0).little(value).finish());
}

bool remote_code::follow(byte_view message) {
  byte_reader in(message);
  switch (static_cast<request_kind>(in.octet())) {
  case request_kind::send:
    answer_with(static_cast<std::uint32_t>(host_->send(in.rest())), true);
    break;
  case request_kind::radio:
    host_->set_radio(in.octet() != 0);
    break;
  case request_kind::timer:
    host_->set_timer(in.little<std::uint64_t>());
    break;
  case request_kind::serial:
    host_->write_serial(in.rest());
    break;
  case request_kind::draw:
    answer_with(host_->draw(), true);
    break;
  case request_kind::read: {
    const auto found = host_->read(to_string(in.rest()));
    answer_with(static_cast<std::uint32_t>(found.value_or(0)), found.has_value());
    break;
  }
  case request_kind::leds:
    host_->set_leds(in.little<std::uint32_t>());
    break;
  case request_kind::log:
    host_->log(to_string(in.rest()));
    break;
  case request_kind::done:
    return false;
  case request_kind::failed:
    throw std::runtime_error(to_string(in.rest()));
  default:
    refuse();
  }
  if (!in.ok())
    refuse();
  return true;
}

void serve(message_pipe& pipe, const std::function<std::unique_ptr<code>()>& load) {
  remote_host its(pipe);
  std::unique_ptr<code> of;
  for (;;) {
    const auto message = pipe.receive();
    pipe.begin_call();
    auto out = begin(request_kind::done);
    try {
      if (!of)
        of = load();
      perform(message, *of, its);
    } catch (const std::exception& x) {
      out = begin(request_kind::failed);
      out.append(to_bytes(std::string_view(x.what()).substr(0, text_octets_max)));
    }
    pipe.send(out.finish());
  }
}

} // namespace rubicon::firmware
