#include "hostile/control_loop.hpp"

#include <algorithm>
#include <charconv>
#include <memory>
#include <optional>
#include <variant>

namespace rubicon::hostile {

namespace {

constexpr duration write_every = 20ms;
constexpr duration ask_every = 200ms;

peer::standalone_config honest_config(const target& whom, peer_id id) {
  peer::standalone_config x;
  x.kernel.network.id = id;
  x.kernel.network.name = "honest";
  x.kernel.network.network = whom.network;
  x.kernel.network.connections.always = {"tcp://127.0.0.1:" + std::to_string(whom.port)};
  x.links.first_port.reset();
  return x;
}

std::unique_ptr<peer::standalone> honest_peer(io::loop& loop, const target& whom, peer_id id) {
  auto opened = peer::standalone::open(loop, honest_config(whom, id));
  return std::get<std::unique_ptr<peer::standalone>>(std::move(opened)); // it listens nowhere
}

double quantile(const std::vector<double>& ascending, double q) {
  if (ascending.empty())
    return 0;
  const auto rank = static_cast<std::size_t>(q * static_cast<double>(ascending.size()));
  return ascending[std::min(rank, ascending.size() - 1)];
}

} // namespace

control_loop::control_loop(const target& whom) : whom_(whom), begun_(clock::now()) {
  thread_ = std::thread([this] { run(); });
}

control_loop::~control_loop() {
  over_ = true;
  thread_.join();
}

void control_loop::run() {
  io::loop loop;
  const auto peer = honest_peer(loop, whom_, whom_.bystander);
  static_cast<void>(peer->tuples().subscribe(whom_.keeper, "probe.echo",
                                             [this](const auto& x) { on_echo(x->text()); }));
  auto next_write = clock::now();
  auto next_ask = clock::now();
  while (!over_) {
    if (clock::now() >= next_write) {
      next_write = std::max(next_write + write_every, clock::now() - write_every);
      write(*peer);
    }
    if (clock::now() >= next_ask && requesting_ && echoes_ > 0) {
      next_ask = clock::now() + ask_every;
      ask(*peer);
    }
    peer->step(std::max(duration(1ms), duration(next_write - clock::now())));
  }
  peer->leave();
}

void control_loop::write(peer::standalone& peer) {
  ++number_;
  {
    const std::lock_guard guard(mutex_);
    open_.push_back({number_, clock::now()});
  }
  static_cast<void>(peer.tuples().set("probe.value", peis::text_content(std::to_string(number_))));
}

void control_loop::on_echo(std::string_view text) {
  std::uint64_t number = 0;
  std::from_chars(text.data(), text.data() + text.size(), number);
  const auto now = clock::now();
  const std::lock_guard guard(mutex_);
  // A newer value stands for those before it.
  while (!open_.empty() && open_.front().number <= number) {
    if (open_.front().when >= begun_)
      done_ms_.push_back(1000 * seconds(now - open_.front().when));
    open_.pop_front();
  }
  ++echoes_;
}

void control_loop::ask(peer::standalone& peer) {
  {
    const std::lock_guard guard(mutex_);
    ++requests_.made;
  }
  const auto note = [this](const peis::outcome& x) {
    const std::lock_guard guard(mutex_);
    ++(x.success ? requests_.done : requests_.failed);
    if (!x.success)
      ++requests_.causes[std::string(to_string(x.why))];
  };
  peer.tuples().set_remote(whom_.keeper, "probe.note", peis::text_content(std::to_string(number_)),
                           note);
}

bool control_loop::await_value(duration patience) {
  const auto before = echoes_.load();
  const auto until = clock::now() + patience;
  while (echoes_ == before && clock::now() < until)
    std::this_thread::sleep_for(5ms);
  return echoes_ != before;
}

void control_loop::begin() {
  const std::lock_guard guard(mutex_);
  begun_ = clock::now();
  done_ms_.clear();
}

loop_figures control_loop::figures() const {
  const std::lock_guard guard(mutex_);
  auto all = done_ms_;
  loop_figures x;
  for (const auto& open : open_) {
    const auto age = 1000 * seconds(clock::now() - open.when);
    if (open.when < begun_ || age < 250)
      continue;
    all.push_back(age);
    ++x.missing;
  }
  std::sort(all.begin(), all.end());
  x.values = all.size();
  x.p50_ms = quantile(all, 0.5);
  x.p99_ms = quantile(all, 0.99);
  x.longest_ms = all.empty() ? 0 : all.back();
  return x;
}

request_figures control_loop::requests() const {
  const std::lock_guard guard(mutex_);
  return requests_;
}

std::optional<double> newcomer_s(const target& whom, duration patience) {
  io::loop loop;
  const auto start = std::chrono::steady_clock::now();
  const auto peer = honest_peer(loop, whom, peer_id{whom.bystander.value + 1});
  const bool in = peer->run_until([&] { return peer->network().reachable(whom.keeper); }, patience);
  const auto took = seconds(std::chrono::steady_clock::now() - start);
  peer->leave();
  return in ? std::optional(took) : std::nullopt;
}

} // namespace rubicon::hostile
