#include "control/client.hpp"

#include <condition_variable>
#include <mutex>
#include <optional>
#include <set>
#include <thread>
#include <utility>

#include "control/caf_system.hpp"
#include "io/tcp_connect.hpp"

namespace rubicon::control {

namespace {

constexpr duration connect_max = 2s;

struct job {
  deploy::question what;
  duration timeout{};
  client::callback done;
};

using outcome = std::variant<deploy::answer, std::string>;

} // namespace

/// The loop's thread asks; a thread of the client's own waits for CAF, which waits for the host.
struct client::state : std::enable_shared_from_this<state> {
  state(system& in, io::loop& loop, std::string where, std::uint16_t number)
      : all(in.inside()), where_loop(loop), address(std::move(where)), port(number) {}

  system::impl& all;
  io::loop& where_loop;
  const std::string address;
  const std::uint16_t port;

  // Of the loop's thread.
  bool is_asking = false;
  bool closed = false;
  bool is_connected = false;
  std::optional<io::tcp_connect> probe; ///< CAF waits for a host that is not there, this does not

  std::mutex guard;
  std::condition_variable changed;
  std::optional<job> waiting; ///< guarded
  bool ends = false;          ///< guarded
  std::thread worker;

  void hand_over(job x) {
    {
      const std::lock_guard lock(guard);
      waiting = std::move(x);
    }
    changed.notify_one();
  }

  void finish(const callback& f, outcome x) {
    is_asking = false;
    is_connected = x.index() == 0;
    f(std::move(x));
  }

  void work() {
    caf::scoped_actor self(all.actors);
    caf::actor remote;
    for (;;) {
      std::optional<job> next;
      {
        std::unique_lock lock(guard);
        changed.wait(lock, [this] { return ends || waiting; });
        if (ends)
          return;
        next = std::exchange(waiting, std::nullopt);
      }
      auto found = perform(self, remote, *next);
      where_loop.post([me = shared_from_this(), f = std::move(next->done),
                       x = std::move(found)]() mutable {
        if (!me->closed)
          me->finish(f, std::move(x));
      });
      where_loop.wake();
    }
  }

  outcome perform(caf::scoped_actor& self, caf::actor& remote, job& x) {
    outcome out;
    if (!remote)
      self->request(all.manager(), x.timeout, caf::connect_atom::value, address, port)
          .receive(
              [&](const caf::node_id&, caf::strong_actor_ptr& found,
                  const std::set<std::string>&) { remote = caf::actor_cast<caf::actor>(found); },
              [&](const caf::error&) {
                out = all.is_secured ? "does not take our certificate, or has none of ours"
                                     : "does not answer as a host of ours, or only to certificates";
              });
    if (!remote)
      return out;
    std::visit(
        [&](auto& question) {
          using answer = typename std::decay_t<decltype(question)>::answer;
          self->request(remote, x.timeout, std::move(question))
              .receive([&](answer& found) { out = deploy::answer(std::move(found)); },
                       [&](const caf::error& why) {
                         out = why == caf::sec::request_timeout ? "does not answer"
                                                                : "cannot be reached any more";
                         remote = nullptr;
                       });
        },
        x.what);
    return out;
  }
};

client::client(system& in, io::loop& where, std::string address, std::uint16_t port)
    : state_(std::make_shared<state>(in, where, std::move(address), port)) {
  state_->worker = std::thread([me = state_] { me->work(); });
}

client::~client() {
  state_->closed = true;
  state_->probe.reset();
  {
    const std::lock_guard lock(state_->guard);
    state_->ends = true;
  }
  state_->changed.notify_one();
  state_->worker.join();
}

void client::ask(deploy::question x, duration timeout, callback f) {
  state_->is_asking = true;
  job next{std::move(x), timeout, std::move(f)};
  if (state_->is_connected)
    return state_->hand_over(std::move(next));
  state_->probe.emplace(
      state_->where_loop, state_->address, state_->port, std::min(timeout, connect_max),
      [me = state_.get(), next = std::make_shared<job>(std::move(next))](auto opened) {
        if (const auto* why = std::get_if<std::string>(&opened))
          me->finish(next->done, "cannot be reached: " + *why);
        else
          me->hand_over(std::move(*next));
      });
}

bool client::is_asking() const {
  return state_->is_asking;
}

std::string client::place() const {
  return state_->address + ':' + std::to_string(state_->port);
}

} // namespace rubicon::control
