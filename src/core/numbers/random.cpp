#include "core/numbers/random.hpp"

#include <atomic>
#include <bit>
#include <cmath>

#include "core/hash.hpp"
#include "core/numbers/math.hpp"

namespace rubicon {

namespace {

constexpr std::uint64_t golden_ratio = 0x9e3779b97f4a7c15ULL;

/// Of splitmix64: one to one, and each bit of the result depends on all.
constexpr std::uint64_t mixed(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

/// 0: what is drawn is as the seeds say. Written while nobody draws, so its order does not matter.
std::atomic<std::uint64_t> draw_key{0};
reseeding::settings reseeded; ///< valid with a key

/// Marsaglia's polar method: needs a logarithm and a square root, both reproducible.
template <class Unit>
double normal_of(Unit unit) {
  for (;;) {
    const auto u = 2 * unit() - 1;
    const auto v = 2 * unit() - 1;
    const auto s = u * u + v * v;
    if (s > 0 && s < 1)
      return u * std::sqrt(-2 * math::log(s) / s);
  }
}

double unit_of(std::uint64_t x) {
  return static_cast<double>(x >> 11) * 0x1p-53;
}

} // namespace

random_stream::random_stream(std::uint64_t seed) {
  for (auto& word : state_) // splitmix64, as the generator's authors advise for seeding
    word = mixed(seed += golden_ratio);
}

random_stream::random_stream(std::uint64_t ecology_seed, std::string_view path)
    : random_stream(fold64().add(ecology_seed).add(path).value()) {}

std::uint64_t random_stream::draw() {
  const auto result = std::rotl(state_[1] * 5, 7) * 9;
  const auto t = state_[1] << 17;
  state_[2] ^= state_[0];
  state_[3] ^= state_[1];
  state_[1] ^= state_[2];
  state_[0] ^= state_[3];
  state_[2] ^= t;
  state_[3] = std::rotl(state_[3], 45);
  return result;
}

std::uint64_t random_stream::next() {
  const auto drawn = draw();
  const auto key = draw_key.load(std::memory_order_relaxed);
  return key == 0 ? drawn : mixed(drawn ^ key);
}

std::uint64_t random_stream::below(std::uint64_t bound) {
  assert(bound > 0);
  const auto reject_below = (0 - bound) % bound; // 2^64 mod bound
  for (;;) {
    if (const auto x = next(); x >= reject_below)
      return x % bound;
  }
}

double random_stream::unit() {
  return unit_of(next());
}

bool random_stream::chance(double p) {
  if (p <= 0)
    return false;
  return p >= 1 || unit() < p;
}

duration random_stream::between(duration from, duration to) {
  assert(from <= to);
  if (from == to)
    return from;
  return from + duration(below(static_cast<std::uint64_t>((to - from).count())));
}

double random_stream::normal() {
  return normal_of([this] { return unit(); });
}

double random_stream::fixed_normal(std::uint64_t seed) {
  random_stream rng(seed);
  return normal_of([&rng] { return unit_of(rng.draw()); });
}

reseeding::reseeding(const settings& x) {
  assert(draw_key.load(std::memory_order_relaxed) == 0);
  reseeded = x;
  const auto key = mixed(x.key + golden_ratio);
  draw_key.store(key == 0 ? 1 : key, std::memory_order_relaxed);
}

reseeding::~reseeding() {
  draw_key.store(0, std::memory_order_relaxed);
}

std::optional<reseeding::settings> reseeding::current() {
  return draw_key.load(std::memory_order_relaxed) == 0 ? std::nullopt : std::optional(reseeded);
}

} // namespace rubicon
