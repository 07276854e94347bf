#include "core/numbers/random.hpp"

#include <bit>
#include <cmath>

#include "core/hash.hpp"
#include "core/numbers/math.hpp"

namespace rubicon {

random_stream::random_stream(std::uint64_t seed) {
  for (auto& word : state_) { // splitmix64, as the generator's authors advise for seeding
    seed += 0x9e3779b97f4a7c15ULL;
    auto z = seed;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    word = z ^ (z >> 31);
  }
}

random_stream::random_stream(std::uint64_t ecology_seed, std::string_view path)
    : random_stream(fold64().add(ecology_seed).add(path).value()) {}

std::uint64_t random_stream::next() {
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

std::uint64_t random_stream::below(std::uint64_t bound) {
  assert(bound > 0);
  const auto reject_below = (0 - bound) % bound; // 2^64 mod bound
  for (;;) {
    if (const auto x = next(); x >= reject_below)
      return x % bound;
  }
}

double random_stream::unit() {
  return static_cast<double>(next() >> 11) * 0x1p-53;
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
  // Marsaglia's polar method: needs a logarithm and a square root, both reproducible.
  for (;;) {
    const auto u = 2 * unit() - 1;
    const auto v = 2 * unit() - 1;
    const auto s = u * u + v * v;
    if (s > 0 && s < 1)
      return u * std::sqrt(-2 * math::log(s) / s);
  }
}

} // namespace rubicon
