#include "control/client.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "control/frame.hpp"
#include "control/octets.hpp"
#include "io/tcp/tcp_connect.hpp"
#include "io/timer.hpp"
#include "io/tls/secure_stream.hpp"

namespace rubicon::control {

namespace {

constexpr duration connect_max = 2s;
constexpr std::uint8_t tls_alert = 0x15; ///< how an answer of TLS begins to what is none

} // namespace

///   away --ask()--> connecting --> shaking --> open --ask(), answer--> open
///    ^                  |             |          |
///    +------------------+-------------+----------+  failure, or the question is given up
struct client::state {
  enum class phase : std::uint8_t { away, connecting, shaking, open };

  state(system& in, io::loop& loop, std::string at, std::uint16_t at_port, std::string name)
      : own(in.own()), where(loop), address(std::move(at)), port(at_port), host(std::move(name)),
        patience(loop) {}

  io::tls_keeper& own;
  io::loop& where;
  const std::string address;
  const std::uint16_t port;
  const std::string host;

  phase now = phase::away;
  callback done;               ///< empty: no question is open
  frame asked;                 ///< as long as it has not been sent
  bool list_pending = false;   ///< the answer that comes first is to that
  std::uint64_t sent_list = 0; ///< number of the list that was sent on this connection
  std::uint8_t answer_kind = 0;
  std::uint32_t number = 0;
  bool has_answered = false; ///< somebody, at some time
  std::optional<io::tcp_connect> attempt;
  std::optional<io::secure_stream> stream;
  frame_reader reader{answer_limits()};
  io::timer patience;

  void begin(deploy::question x, duration timeout, callback f) {
    done = std::move(f);
    asked = {static_cast<std::uint8_t>(x.index()), ++number, octets_of(x)};
    answer_kind = control::answer_kind(asked.kind);
    if (asked.content.size() > question_limits()[asked.kind])
      return patience.start({}, [this] { fail("cannot be asked: the request is too long"); });
    patience.start(timeout, [this] { fail(why_late()); });
    static_cast<void>(own.look()); // if it is not valid any more, the other side says so
    if (now == phase::open)
      return send();
    now = phase::connecting;
    stream.reset();
    attempt.emplace(where, address, port, std::min(timeout, connect_max), [this](auto opened) {
      attempt.reset();
      if (const auto* why = std::get_if<std::string>(&opened))
        fail("cannot be reached: " + *why);
      else
        connected(std::get<io::tcp_stream>(std::move(opened)));
    });
  }

  void connected(io::tcp_stream x) {
    now = phase::shaking;
    reader = frame_reader{answer_limits()};
    stream.emplace(
        std::move(x), own.identity(), io::tls_session::side::client, host,
        io::secure_stream::callbacks{[this](const std::string&) { ready(); },
                                     [this](byte_view octets) { on_octets(octets); }, [] {},
                                     [this](const std::string& why) { on_closed(why); }});
    if (!own.identity())
      ready();
  }

  void ready() {
    now = phase::open;
    sent_list = 0;
    send();
  }

  /// A greeting comes before the list: other versions may not know what that is.
  void send() {
    const auto& list = own.revoked();
    list_pending = list && list->number() != sent_list &&
                   asked.kind != deploy::question(deploy::greeting{}).index();
    if (!list_pending)
      return send(std::exchange(asked, {asked.kind, asked.number, {}}));
    sent_list = list->number();
    const deploy::question x = deploy::send_revoked{list->text()};
    send({static_cast<std::uint8_t>(x.index()), 0, octets_of(x)});
  }

  void send(frame x) {
    stream->send(encode_header(x));
    stream->send(std::move(x.content));
  }

  void on_octets(byte_view octets) {
    if (!own.identity() && !has_answered && !octets.empty() && octets.front() == tls_alert)
      return fail("does not answer as a rubicon host without certificates: it speaks TLS");
    while (!octets.empty() && reader.now() != frame_reader::state::complete &&
           reader.now() != frame_reader::state::refused)
      octets = octets.subspan(reader.feed(octets));
    if (reader.now() == frame_reader::state::refused)
      return fail("does not answer as a rubicon host: " + reader.problem());
    if (reader.now() == frame_reader::state::complete)
      on_answer(reader.take(), !octets.empty());
  }

  void on_answer(const frame& x, bool is_followed) {
    if (list_pending) { // the result is in the host's log, and in its facts
      if (is_followed || x.number != 0)
        return fail("sent an answer to no request");
      list_pending = false;
      return send();
    }
    if (!done || is_followed || x.number != number || x.kind != answer_kind)
      return fail("sent an answer to no request");
    auto found = answer_of(x.kind, x.content);
    if (!found)
      return fail("sent an invalid answer");
    has_answered = true;
    patience.stop();
    std::exchange(done, nullptr)(*std::move(found));
  }

  void on_closed(const std::string& why) {
    if (now == phase::shaking)
      return fail(why);
    if (has_answered)
      return fail("cannot be reached any longer");
    fail(own.identity() ? why : "does not answer as a rubicon host without certificates: " + why);
  }

  [[nodiscard]] std::string why_late() const {
    if (now == phase::open && has_answered)
      return "does not answer";
    return own.identity() ? "does not answer as a rubicon host with certificates"
                          : "does not answer as a rubicon host without certificates";
  }

  /// The connection is of no use any more.
  void fail(std::string why) {
    now = phase::away;
    patience.stop();
    attempt.reset();
    stream.reset();
    if (done)
      std::exchange(done, nullptr)(std::move(why));
  }
};

client::client(system& in, io::loop& where, std::string address, std::uint16_t port,
               std::string host)
    : state_(std::make_unique<state>(in, where, std::move(address), port, std::move(host))) {}

client::~client() = default;

void client::ask(deploy::question x, duration timeout, callback f) {
  state_->begin(std::move(x), timeout, std::move(f));
}

bool client::is_asking() const {
  return state_->done != nullptr;
}

std::string client::place() const {
  return state_->address + ':' + std::to_string(state_->port);
}

} // namespace rubicon::control
