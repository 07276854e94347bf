#include "peer/standalone.hpp"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <random>

#include <unistd.h>

#include "io/process/machine.hpp"

namespace rubicon::peer {

namespace {

/// Attempts of the program itself: above those that the kernel numbers from 1 on.
constexpr std::uint64_t own_attempts = std::uint64_t{1} << 63;
constexpr duration flush_max = 2s; ///< of a clean exit (peis-wire.md 20)

std::uint64_t seed_of_system() {
  std::random_device device;
  return static_cast<std::uint64_t>(device()) << 32 | device();
}

std::string in_ms(duration x) {
  return std::to_string(std::chrono::duration_cast<std::chrono::milliseconds>(x).count()) + " ms";
}

} // namespace

standalone::standalone(io::loop& where, standalone_config config)
    : loop_(&where), config_(std::move(config)), start_(std::chrono::steady_clock::now()),
      next_attempt_(own_attempts) {}

std::variant<std::unique_ptr<standalone>, std::string> standalone::open(io::loop& where,
                                                                        standalone_config config) {
  std::unique_ptr<standalone> x(new standalone(where, std::move(config)));
  auto links = tcp_links::open(where, x->config_.links, *x);
  if (auto* refusal = std::get_if<std::string>(&links))
    return std::move(*refusal);
  x->start(std::move(std::get<std::unique_ptr<tcp_links>>(links)));
  return x;
}

void standalone::start(std::unique_ptr<tcp_links> links) {
  links_ = std::move(links);
  auto& network = config_.kernel.network;
  const standalone_config unset;
  if (network.host_name == unset.kernel.network.host_name)
    network.host_name = io::machine_name();
  if (network.process == 0)
    network.process = static_cast<std::uint32_t>(::getpid());
  addresses_are_given_ = !network.addresses.empty();
  if (!addresses_are_given_)
    network.addresses = links_->addresses();
  if (const char* user = std::getenv("USER"); config_.kernel.user == unset.kernel.user && user)
    config_.kernel.user = user;
  if (network.link_window == 0)
    network.link_window = tcp_links::window;
  network.connections.announces = network.connections.announces && config_.links.lan;
  if (network.connections.networks.empty())
    network.connections.networks = config_.links.networks;
  network.clock_offset = std::chrono::system_clock::now().time_since_epoch() - (now() - instant{});
  if (!config_.seed)
    config_.seed = seed_of_system();
  kernel_ = peis::kernel(config_.kernel, random_stream(*config_.seed), now());
  if (!links_->warning().empty() && config_.on_warning)
    config_.on_warning(links_->warning());
}

standalone::~standalone() = default;

instant standalone::now() const {
  return instant(std::chrono::steady_clock::now() - start_);
}

io::loop::time_point standalone::real(instant x) const {
  return start_ + x.time_since_epoch();
}

void standalone::step(duration wait_max) {
  check_step_gap();
  const auto begun = now();
  drain();
  const auto latest = now() + wait_max;
  auto until = latest;
  if (const auto deadline = kernel_.deadline())
    until = std::min(until, *deadline);
  for (const auto& x : periodics_) {
    if (x.period > 0s)
      until = std::min(until, x.next);
  }
  loop_->wait_until(real(until));
  const auto deadline = kernel_.deadline();
  if (deadline && *deadline <= now())
    perform(kernel_.on_time(now()));
  drain();
  run_periodics();
  last_step_ = now();
  kernel_.note_step(*last_step_ - begun);
}

void standalone::run_every(duration period, std::function<void()> f) {
  periodics_.push_back({period, now() + period, std::move(f)});
}

/// A callback that waits steps the peer again: what is due is put off before it is called.
void standalone::run_periodics() {
  const auto count = periodics_.size();
  for (std::size_t i = 0; i < count; ++i) {
    auto& x = periodics_[i];
    if (x.next > now())
      continue;
    if (x.period > 0s)
      x.next += ((now() - x.next) / x.period + 1) * x.period;
    call_user("a period", x.f);
  }
}

bool standalone::run_until(const std::function<bool()>& done, duration timeout) {
  const auto end = now() + timeout;
  while (!done()) {
    const auto left = end - now();
    if (left <= 0s)
      return false;
    step(left);
  }
  return true;
}

void standalone::check_step_gap() {
  if (!last_step_)
    return;
  const auto gap = now() - *last_step_;
  if (gap > step_gap_max)
    warn(rare_steps_,
         "the peer was not stepped for " + in_ms(gap) + "; it needs a step every 50 ms at least");
}

void standalone::warn(rate_limiter& kind, const std::string& text) {
  if (!config_.on_warning || (kind.last && now() - *kind.last < warning_gap))
    return;
  kind.last = now();
  config_.on_warning(text);
}

void standalone::connect(const std::string& url) {
  links_->carry_out(peis::connect_to{peis::attempt_id{next_attempt_++}, url});
}

void standalone::leave() {
  perform(kernel_.leave(now()));
  run_until([this] { return links_->unsent() == 0; }, flush_max);
  links_->close_all();
  run_until([this] { return links_->closing_links() == 0; },
            io::tcp_stream::drain_max + io::tcp_stream::linger_max);
}

// Events of links.

void standalone::on_link_open(peis::link_id link, peis::link_role role,
                              std::optional<peis::attempt_id> attempt) {
  if (attempt && attempt->value >= own_attempts)
    attempt.reset();
  perform(kernel_.on_link_open(link, role, now(), attempt));
}

void standalone::on_attempt_failed(peis::attempt_id attempt, const std::string& why) {
  warn(failed_attempt_, why);
  if (attempt.value >= own_attempts)
    return;
  perform(kernel_.on_attempt_failed(attempt, now()));
}

void standalone::on_link_octets(peis::link_id link, byte_view octets) {
  perform(kernel_.on_link_octets(link, octets, now()));
}

void standalone::on_link_sent(peis::link_id link, std::size_t octets) {
  perform(kernel_.on_link_sent(link, octets, now()));
}

void standalone::on_link_closed(peis::link_id link, const std::string&) {
  perform(kernel_.on_link_closed(link, now()));
}

void standalone::on_announcement(byte_view datagram, const ipv4_address& from) {
  perform(kernel_.on_announcement(datagram, now(), from));
}

void standalone::on_addresses() {
  if (!addresses_are_given_)
    perform(kernel_.set_addresses(links_->addresses(), now()));
}

// What the kernel wants.

/// Outputs of calls that callbacks make wait until those before them are done: octets of a link
/// must keep their order.
void standalone::perform(peis::outputs todo) {
  for (auto& x : todo)
    todo_.push_back(std::move(x));
  if (!draining_)
    drain();
}

void standalone::drain() {
  const bool nested = std::exchange(draining_, true);
  while (!todo_.empty()) {
    auto x = std::move(todo_.front());
    todo_.pop_front();
    std::visit([this](auto& what) { this->handle(what); }, x);
  }
  draining_ = nested;
}

template <class F>
void standalone::call_user(const char* what, F&& f) {
  const auto begin = now();
  f();
  const auto length = now() - begin;
  if (length > callback_max) {
    std::string text("a callback for ");
    warn(slow_callback_, text.append(what).append(" took ").append(in_ms(length)));
  }
}

void standalone::handle(peis::close_link& x) {
  links_->carry_out(x);
}

void standalone::handle(peis::tuple_changed& x) {
  const auto found = watchers_.find(x.subscription);
  if (found == watchers_.end() || !found->second->changed)
    return;
  call_user("a tuple", [&, watcher = found->second] { watcher->changed(x.content); });
}

void standalone::handle(peis::tuple_deleted& x) {
  const auto found = watchers_.find(x.subscription);
  if (found == watchers_.end() || !found->second->deleted)
    return;
  call_user("a tuple", [&, watcher = found->second] { watcher->deleted(x.content); });
}

void standalone::handle(peis::message& x) {
  const auto found = hooks_.find(x.port);
  if (found == hooks_.end())
    return;
  const auto hooks = found->second; // a hook may add another
  for (const auto& hook : hooks)
    call_user("a message", [&] { hook(x); });
}

void standalone::handle(peis::outcome& x) {
  const auto ended = expected_.extract(x.request);
  if (!ended.empty() && ended.mapped())
    call_user("an outcome", [&] { ended.mapped()(x); });
}

void standalone::handle(peis::host_appeared& x) {
  if (on_host_)
    call_user("a host", [&] { on_host_(x.host, true); });
}

void standalone::handle(peis::host_vanished& x) {
  if (on_host_)
    call_user("a host", [&] { on_host_(x.host, false); });
}

void standalone::handle(peis::quit_requested&) {
  quit_requested_ = true;
}

void standalone::handle(const peis::namesake_found& x) {
  if (config_.on_warning)
    config_.on_warning("the computer of " + x.full_name + " has the same name as this one");
}

void standalone::handle(peis::id_taken& x) {
  warn(taken_id_, (x.stays_away == duration(0) ? "another peer uses our id: "
                                               : "our id is left for a while to ") +
                      x.by);
}

void standalone::handle(peis::traced& x) {
  const auto found = traces_.find(x.request);
  if (found != traces_.end())
    found->second = std::move(x.way);
}

// Calls.

peis::cause standalone::call(
    const std::function<peis::outputs(peis::kernel&, peis::request_id, instant)>& command,
    outcome_callback then) {
  const peis::request_id request{next_request_++};
  if (then)
    expected_.emplace(request, std::move(then));
  auto todo = command(kernel_, request, now());
  auto why = peis::cause::none;
  for (const auto& x : todo) {
    const auto* ended = std::get_if<peis::outcome>(&x);
    if (ended != nullptr && ended->request == request)
      why = ended->why;
  }
  perform(std::move(todo));
  return why;
}

std::optional<peis::cause> standalone::await(duration timeout,
                                             const std::function<void(outcome_callback)>& begin) {
  // Shared: the outcome may come after the wait was given up.
  const auto ended = std::make_shared<std::optional<peis::cause>>();
  begin([ended](const peis::outcome& x) { *ended = x.why; });
  run_until([&] { return ended->has_value(); }, timeout);
  return *ended;
}

peis::cause standalone::set_tuple(std::string_view key, peis::tuple_content content) {
  return call([&](auto& kernel, auto request, auto time) {
    return kernel.set_tuple(key, std::move(content), time, request);
  });
}

peis::cause standalone::delete_tuple(std::string_view key) {
  return call([&](auto& kernel, auto request, auto time) {
    return kernel.delete_tuple(key, time, request);
  });
}

peis::cause standalone::insert_tuple(peis::tuple draft, outcome_callback then) {
  return call([&](auto& kernel, auto request,
                  auto time) { return kernel.insert_tuple(std::move(draft), time, request); },
              std::move(then));
}

peis::cause standalone::append_tuple(const peis::prototype& wanted, payload added,
                                     outcome_callback then) {
  return call(
      [&](auto& kernel, auto request, auto time) {
        return kernel.append_tuple(wanted, std::move(added), time, request);
      },
      std::move(then));
}

peis::cause standalone::set_remote_tuple(peer_id owner, std::string_view key,
                                         peis::tuple_content content, outcome_callback then) {
  return call(
      [&](auto& kernel, auto request, auto time) {
        return kernel.set_remote_tuple(owner, key, std::move(content), request, time);
      },
      std::move(then));
}

peis::cause standalone::delete_remote_tuple(peer_id owner, std::string_view key,
                                            outcome_callback then) {
  return call([&](auto& kernel, auto request,
                  auto time) { return kernel.delete_remote_tuple(owner, key, request, time); },
              std::move(then));
}

standalone::watch_result standalone::watch(const watch_command& command, tuple_callback changed,
                                           tuple_callback deleted) {
  const peis::subscription_id id{next_subscription_++};
  watchers_[id] = std::make_shared<watcher>(watcher{std::move(changed), std::move(deleted)});
  const auto why = call([&](auto&, auto request, auto time) { return command(id, request, time); });
  if (why == peis::cause::none)
    return id;
  watchers_.erase(id);
  return why;
}

standalone::watch_result standalone::subscribe(peer_id owner, std::string_view pattern,
                                               tuple_callback changed, tuple_callback deleted) {
  return watch([&](auto id, auto request,
                   auto time) { return kernel_.subscribe(owner, pattern, id, time, request); },
               std::move(changed), std::move(deleted));
}

standalone::watch_result standalone::subscribe(const peis::prototype& wanted,
                                               tuple_callback changed, tuple_callback deleted) {
  return watch([&](auto id, auto request,
                   auto time) { return kernel_.subscribe(wanted, id, time, request); },
               std::move(changed), std::move(deleted));
}

standalone::watch_result standalone::register_callback(const peis::prototype& wanted,
                                                       tuple_callback changed,
                                                       tuple_callback deleted) {
  return watch([&](auto id, auto request,
                   auto time) { return kernel_.register_callback(wanted, id, time, request); },
               std::move(changed), std::move(deleted));
}

void standalone::unsubscribe(peis::subscription_id id) {
  watchers_.erase(id);
  perform(kernel_.unsubscribe(id, now()));
}

peis::reading standalone::get_tuple(peer_id owner, std::string_view key, peis::read_mode mode) {
  return kernel_.get_tuple(owner, key, mode, now());
}

peis::reading standalone::get_tuple(const peis::prototype& wanted, peis::read_mode mode) {
  return kernel_.get_tuple(wanted, mode, now());
}

peis::reading standalone::get_tuple(peer_id owner, std::string_view key, peis::read_mode mode,
                                    duration timeout) {
  auto found = get_tuple(owner, key, mode);
  run_until(
      [&] {
        if (!found && found.why == peis::cause::none)
          found = get_tuple(owner, key, mode);
        return found || found.why != peis::cause::none;
      },
      timeout);
  return found;
}

void standalone::get_tuples(const peis::prototype& wanted, peis::result_set& into,
                            peis::read_mode mode) {
  kernel_.get_tuples(wanted, into, now(), mode);
}

bool standalone::has_subscriber(std::string_view key) const {
  return kernel_.has_subscriber(key);
}

peis::cause standalone::send_message(std::uint16_t port, peer_id destination, payload octets,
                                     bool reliable, peis::priority class_of_service,
                                     outcome_callback then) {
  return call(
      [&](auto& kernel, auto request, auto time) {
        return kernel.send_message(destination, port, std::move(octets), reliable, class_of_service,
                                   request, time);
      },
      std::move(then));
}

peis::cause standalone::broadcast(std::uint16_t port, payload octets) {
  return call([&](auto& kernel, auto request, auto time) {
    return kernel.broadcast(port, std::move(octets), request, time);
  });
}

bool standalone::register_hook(std::uint16_t port, message_callback hook) {
  if (!kernel_.hook_port(port))
    return false;
  hooks_[port].push_back(std::move(hook));
  return true;
}

std::optional<std::vector<peer_id>> standalone::trace(peer_id destination, duration timeout) {
  const peis::request_id request{next_request_++};
  traces_[request];
  perform(kernel_.trace(destination, request, now()));
  run_until([&] { return !traces_.at(request).empty(); }, timeout);
  auto route = std::move(traces_.extract(request).mapped());
  return route.empty() ? std::nullopt : std::optional(std::move(route));
}

} // namespace rubicon::peer
