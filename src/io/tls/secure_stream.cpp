#include "io/tls/secure_stream.hpp"

#include <algorithm>
#include <cassert>
#include <deque>
#include <utility>

namespace rubicon::io {

namespace {

constexpr std::size_t piece_octets = 64 * 1024;
constexpr std::size_t in_stream_max = 256 * 1024;

} // namespace

struct secure_stream::state : std::enable_shared_from_this<state> {
  state(tcp_stream below, callbacks x) : stream(std::move(below)), to_owner(std::move(x)) {}

  tcp_stream stream;
  callbacks to_owner;
  std::optional<tls_session> session;
  std::deque<payload> output;
  std::size_t gone = 0; ///< octets of output.front() that have left
  std::size_t waiting = 0;
  bool was_ready = false;
  bool is_sending = false;
  bool over = false; ///< the owner is not called any more

  void start() {
    const auto self = weak_from_this();
    const auto when_alive = [self](auto f) {
      if (const auto x = self.lock(); x && !x->over)
        f(*x);
    };
    stream.start({[when_alive](byte_view octets) {
                    when_alive([octets](state& x) { x.on_octets(octets); });
                  },
                  [when_alive](std::size_t) { when_alive([](state& x) { x.on_sent(); }); },
                  [when_alive](const std::string& why) {
                    when_alive([&why](state& x) { x.on_closed(why); });
                  }});
    flush_session();
  }

  void on_octets(byte_view octets) {
    if (!session) {
      to_owner.on_octets(octets);
      return;
    }
    const auto said = session->take(octets);
    flush_session();
    if (!was_ready && (session->now() == tls_session::phase::open ||
                       (session->now() == tls_session::phase::closed && !said.empty()))) {
      was_ready = true;
      to_owner.on_ready(session->peer_name());
    }
    if (!over && !said.empty())
      to_owner.on_octets(said);
    if (!over && session->now() == tls_session::phase::closed)
      finish(session->why());
  }

  void flush_session() {
    if (auto octets = session ? session->outgoing() : bytes(); !octets.empty())
      stream.send(payload(std::move(octets)));
  }

  void on_closed(const std::string& why) {
    const bool is_shaking = session && session->now() == tls_session::phase::shaking;
    finish(std::string("closed the connection") + (is_shaking ? " before it authenticated" : "") +
           " (" + why + ')');
  }

  void finish(const std::string& why) {
    over = true;
    to_owner.on_closed(why);
  }

  void pump() {
    while (!output.empty() && stream.unsent() < in_stream_max)
      send_piece();
  }

  void on_sent() {
    pump();
    if (is_sending && output.empty() && stream.unsent() == 0) {
      is_sending = false;
      to_owner.on_sent();
    }
  }

  void send_piece() {
    const auto& first = output.front();
    const auto size = std::min(first.size() - gone, piece_octets);
    if (session && session->now() == tls_session::phase::open) {
      session->send(first.view().subspan(gone, size));
      flush_session();
    } else if (!session) {
      stream.send(first.part(gone, size));
    }
    gone += size;
    waiting -= size;
    if (gone == first.size()) {
      output.pop_front();
      gone = 0;
    }
  }

  void close() {
    over = true; // what calls us now lives until it returns
    if (session) {
      session->close();
      flush_session();
    }
    stream.close();
  }
};

secure_stream::secure_stream(tcp_stream over, const std::optional<tls_identity>& own,
                             tls_session::side which, const std::string& name, callbacks to_owner)
    : state_(std::make_shared<state>(std::move(over), std::move(to_owner))) {
  if (own)
    state_->session.emplace(*own, which, name);
  state_->start();
}

secure_stream::~secure_stream() {
  if (state_)
    state_->close();
}

secure_stream::secure_stream(secure_stream&&) noexcept = default;

void secure_stream::read(bool wanted) {
  state_->stream.read(wanted);
}

void secure_stream::send(payload octets) {
  auto& x = *state_;
  assert(!x.session || x.was_ready);
  if (octets.empty())
    return;
  x.is_sending = true;
  x.waiting += octets.size();
  x.output.push_back(std::move(octets));
  x.pump();
}

std::string secure_stream::why_revoked(const revocation_list& x) const {
  return state_->session ? state_->session->why_revoked(x) : "";
}

std::size_t secure_stream::unsent() const {
  return state_->waiting + state_->stream.unsent();
}

} // namespace rubicon::io
