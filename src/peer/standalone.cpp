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
constexpr duration flush_max = 2s; ///< of a clean exit (docs/peis-wire.md 19)

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
      next_attempt_(own_attempts), warnings_(config_.on_warning) {}

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
  if (!links_->warning().empty())
    warnings_.give(links_->warning());
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
    warnings_.give(warnings::kind::rare_steps,
                   "the peer was not stepped for " + in_ms(gap) +
                       "; it needs a step every 50 ms at least",
                   now());
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
  warnings_.give(warnings::kind::failed_attempt, why, now());
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

// Outputs of the kernel.

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

/// @param f may be empty
template <class F>
void standalone::call_user(const char* what, F&& f) {
  if (!f)
    return;
  const auto begin = now();
  f();
  const auto length = now() - begin;
  if (length > callback_max) {
    std::string text("a callback for ");
    warnings_.give(warnings::kind::slow_callback,
                   text.append(what).append(" took ").append(in_ms(length)), now());
  }
}

void standalone::handle(peis::close_link& x) {
  links_->carry_out(x);
}

void standalone::handle(peis::tuple_changed& x) {
  call_user("a tuple", callbacks_.on(x));
}

void standalone::handle(peis::tuple_deleted& x) {
  call_user("a tuple", callbacks_.on(x));
}

/// A hook may add another.
void standalone::handle(peis::message& x) {
  for (const auto& hook : callbacks_.hooks(x.port))
    call_user("a message", std::function<void()>([&] { hook(x); }));
}

void standalone::handle(peis::outcome& x) {
  call_user("an outcome", callbacks_.on(x));
}

void standalone::handle(peis::host_appeared& x) {
  call_user("a host", callbacks_.on(x));
}

void standalone::handle(peis::host_vanished& x) {
  call_user("a host", callbacks_.on(x));
}

void standalone::handle(peis::quit_requested&) {
  quit_requested_ = true;
}

void standalone::handle(const peis::namesake_found& x) {
  warnings_.give("the computer of " + x.full_name + " has the same name as this one");
}

void standalone::handle(peis::id_taken& x) {
  warnings_.give(warnings::kind::taken_id,
                 (x.stays_away == duration(0) ? "another peer uses our id: "
                                              : "our id is left for a while to ") +
                     x.by,
                 now());
}

void standalone::handle(peis::traced& x) {
  callbacks_.on(x);
}

// Calls.

peis::cause standalone::call(
    const std::function<peis::outputs(peis::kernel&, peis::request_id, instant)>& command,
    outcome_callback then) {
  const auto request = callbacks_.add_request(std::move(then));
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

} // namespace rubicon::peer
