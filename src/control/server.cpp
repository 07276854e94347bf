#include "control/server.hpp"

#include <atomic>
#include <future>
#include <utility>

#include "control/caf_system.hpp"
#include "core/time.hpp"

namespace rubicon::control {

namespace {

/// What actor and server share: the actor may be in the middle of a question when the server ends.
struct desk {
  desk(io::loop& loop, server::handler f) : where(loop), answer(std::move(f)) {}

  io::loop& where; ///< not touched once it is closed
  server::handler answer;
  std::atomic<bool> closed = false;
};

template <class Question>
caf::result<typename Question::answer> ask(const std::shared_ptr<desk>& at, Question& x) {
  using answer = typename Question::answer;
  if (at->closed)
    return caf::make_error(caf::exit_reason::user_shutdown);
  auto answered = std::make_shared<std::promise<answer>>();
  auto found = answered->get_future();
  at->where.post([at, answered, x = std::move(x)]() mutable {
    if (!at->closed)
      answered->set_value(std::get<answer>(at->answer(deploy::question(std::move(x)))));
  });
  at->where.wake();
  while (found.wait_for(20ms) != std::future_status::ready)
    if (at->closed)
      return caf::make_error(caf::exit_reason::user_shutdown);
  return found.get();
}

/// Holds up a thread of the scheduler while it waits for the loop: nothing else needs that one. (A
/// detached actor that could not be published would keep its thread, and the system with it.)
caf::behavior server_actor(caf::event_based_actor* /*self*/, const std::shared_ptr<desk>& at) {
  return {
      [at](deploy::greeting& x) { return ask(at, x); },
      [at](deploy::ask_facts& x) { return ask(at, x); },
      [at](deploy::offer& x) { return ask(at, x); },
      [at](deploy::begin_part& x) { return ask(at, x); },
      [at](deploy::end_part& x) { return ask(at, x); },
      [at](deploy::cause_fault& x) { return ask(at, x); },
      [at](deploy::ask_news& x) { return ask(at, x); },
      [at](deploy::offer_seeds& x) { return ask(at, x); },
      [at](deploy::run_seeds& x) { return ask(at, x); },
  };
}

} // namespace

struct server::state {
  state(system& in, io::loop& where, handler f)
      : all(in.inside()), at(std::make_shared<desk>(where, std::move(f))),
        actor(all.actors.spawn(server_actor, at)) {}
  ~state() {
    at->closed = true;
    caf::anon_send_exit(actor, caf::exit_reason::user_shutdown);
  }
  state(const state&) = delete;
  state& operator=(const state&) = delete;

  system::impl& all;
  std::shared_ptr<desk> at;
  caf::actor actor;
  std::uint16_t port = 0;
};

std::variant<server, std::string> server::open(system& in, io::loop& where,
                                               const std::string& address, std::uint16_t port,
                                               handler f) {
  auto made = std::make_unique<state>(in, where, std::move(f));
  auto& all = made->all;
  const auto opened =
      all.is_secured
          ? caf::openssl::publish(made->actor, port, address.c_str(), /*reuse=*/true)
          : all.actors.middleman().publish(made->actor, port, address.c_str(), /*reuse=*/true);
  if (!opened)
    return "cannot listen on " + address + ':' + std::to_string(port) +
           ": the port is taken, or the address is not one of this computer";
  made->port = *opened;
  return server(std::move(made));
}

server::server(std::unique_ptr<state> x) : state_(std::move(x)) {}
server::~server() = default;
server::server(server&&) noexcept = default;
server& server::operator=(server&&) noexcept = default;

std::uint16_t server::port() const {
  return state_->port;
}

} // namespace rubicon::control
