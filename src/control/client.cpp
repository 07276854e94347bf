#include "control/client.hpp"

#include <mutex>
#include <optional>
#include <set>
#include <utility>

#include "control/caf_system.hpp"
#include "io/tcp_connect.hpp"

namespace rubicon::control {

namespace {

constexpr duration connect_max = 2s;

using outcome = std::variant<deploy::answer, std::string>;

/// A question on its way. What an earlier one comes back with is not wanted any more.
struct open_question {
  deploy::question what;
  duration timeout{};
  std::uint64_t number = 0;
};

} // namespace

/// What the loop's thread and the actor share.
struct client::state : std::enable_shared_from_this<state> {
  state(system& in, io::loop& loop, std::string where, std::uint16_t at)
      : all(in.inside()), where_loop(loop), address(std::move(where)), port(at) {}

  system::impl& all;
  io::loop& where_loop; ///< not touched by the actor once it is closed
  const std::string address;
  const std::uint16_t port;
  caf::actor actor;

  // Of the loop's thread.
  callback done; ///< empty: no question is open
  bool is_connected = false;
  std::uint64_t number = 0;
  std::optional<io::tcp_connect> probe; ///< CAF waits for a host that is not there, this does not

  std::mutex guard;
  std::optional<open_question> waiting; ///< guarded, as is
  bool closed = false;

  void hand_over(open_question x) {
    {
      const std::lock_guard lock(guard);
      waiting = std::move(x);
    }
    caf::anon_send(actor, caf::tick_atom::value);
  }

  [[nodiscard]] std::optional<open_question> take() {
    const std::lock_guard lock(guard);
    return std::exchange(waiting, std::nullopt);
  }

  /// From the actor.
  void finish(std::uint64_t of, outcome x) {
    const std::lock_guard lock(guard);
    if (closed)
      return;
    where_loop.post([me = shared_from_this(), of, x = std::move(x)]() mutable {
      me->finish_here(of, std::move(x));
    });
    where_loop.wake();
  }

  void finish_here(std::uint64_t of, outcome x) {
    if (of != number || !done)
      return;
    is_connected = x.index() == 0;
    std::exchange(done, nullptr)(std::move(x));
  }
};

/// Asks, through a connection that it makes when there is none.
class client::asker : public caf::event_based_actor {
public:
  asker(caf::actor_config& config, std::shared_ptr<state> with)
      : caf::event_based_actor(config), with_(std::move(with)) {
    set_down_handler([this](caf::down_msg& x) {
      if (remote_ && x.source == remote_) {
        remote_ = nullptr;
        fail(number_, "cannot be reached any more");
      }
    });
  }

  caf::behavior make_behavior() override {
    return {[this](caf::tick_atom) {
      if (auto next = with_->take())
        begin(*std::move(next));
    }};
  }

private:
  void begin(open_question x) {
    number_ = x.number;
    if (remote_)
      return ask(std::move(x));
    auto next = std::make_shared<open_question>(std::move(x));
    request(with_->all.manager(), next->timeout, caf::connect_atom::value, with_->address,
            with_->port)
        .then(
            [this, next](const caf::node_id&, caf::strong_actor_ptr& found,
                         const std::set<std::string>&) {
              remote_ = caf::actor_cast<caf::actor>(found);
              was_connected_ = true;
              monitor(remote_);
              if (next->number == number_)
                ask(std::move(*next));
            },
            [this, next](const caf::error&) { fail(next->number, why_no_connection()); });
  }

  void ask(open_question x) {
    std::visit(
        [&, number = x.number](auto& question) {
          using answer = typename std::decay_t<decltype(question)>::answer;
          request(remote_, x.timeout, std::move(question))
              .then([this, number](
                        answer& found) { with_->finish(number, deploy::answer(std::move(found))); },
                    [this, number](const caf::error&) {
                      if (number == number_)
                        remote_ = nullptr; // to be found anew
                      fail(number, "does not answer");
                    });
        },
        x.what);
  }

  [[nodiscard]] std::string why_no_connection() const {
    if (was_connected_)
      return "cannot be reached any more";
    return with_->all.is_secured ? "does not take our certificate, or has none of ours"
                                 : "does not answer as a host of ours, or only to certificates";
  }

  void fail(std::uint64_t number, const std::string& why) { with_->finish(number, why); }

  std::shared_ptr<state> with_;
  caf::actor remote_;
  bool was_connected_ = false;
  std::uint64_t number_ = 0; ///< of the newest question
};

client::client(system& in, io::loop& where, std::string address, std::uint16_t port)
    : state_(std::make_shared<state>(in, where, std::move(address), port)) {
  state_->actor = state_->all.actors.spawn<asker>(state_);
}

client::~client() {
  state_->probe.reset();
  state_->done = nullptr;
  caf::anon_send_exit(state_->actor, caf::exit_reason::user_shutdown);
  state_->actor = nullptr;
  const std::lock_guard lock(state_->guard);
  state_->closed = true;
}

void client::ask(deploy::question x, duration timeout, callback f) {
  auto& all = *state_;
  all.done = std::move(f);
  open_question next{std::move(x), timeout, ++all.number};
  if (all.is_connected)
    return all.hand_over(std::move(next));
  all.probe.emplace(
      all.where_loop, all.address, all.port, std::min(timeout, connect_max),
      [me = state_.get(), next = std::make_shared<open_question>(std::move(next))](auto opened) {
        if (const auto* why = std::get_if<std::string>(&opened))
          me->finish_here(next->number, "cannot be reached: " + *why);
        else
          me->hand_over(std::move(*next));
      });
}

bool client::is_asking() const {
  return state_->done != nullptr;
}

std::string client::place() const {
  return state_->address + ':' + std::to_string(state_->port);
}

} // namespace rubicon::control
