#include "peis/udp/udp_cookie.hpp"

#include <algorithm>
#include <bit>

#include "core/codec.hpp"

namespace rubicon::peis {

namespace {

// What a number is for; no octets of one use are those of another.
constexpr std::uint8_t for_token = 1;
constexpr std::uint8_t for_cookie = 2;

using words = std::array<std::uint64_t, 4>;

void mix(words& v, int rounds) {
  for (int i = 0; i < rounds; ++i) {
    v[0] += v[1];
    v[2] += v[3];
    v[1] = std::rotl(v[1], 13) ^ v[0];
    v[3] = std::rotl(v[3], 16) ^ v[2];
    v[0] = std::rotl(v[0], 32) + v[3];
    v[2] += v[1];
    v[1] = std::rotl(v[1], 17) ^ v[2];
    v[3] = std::rotl(v[3], 21) ^ v[0];
    v[2] = std::rotl(v[2], 32);
  }
}

void absorb(words& v, std::uint64_t word) {
  v[3] ^= word;
  mix(v, 2);
  v[0] ^= word;
}

} // namespace

std::uint64_t keyed_hash(const udp_secret& key, byte_view octets) {
  words v = {key[0] ^ 0x736f6d6570736575, key[1] ^ 0x646f72616e646f6d, key[0] ^ 0x6c7967656e657261,
             key[1] ^ 0x7465646279746573};
  const auto length = static_cast<std::uint64_t>(octets.size());
  while (octets.size() >= 8) {
    byte_reader from(octets.first(8));
    absorb(v, from.little<std::uint64_t>());
    octets = octets.subspan(8);
  }
  auto last = length << 56;
  for (std::size_t i = 0; i < octets.size(); ++i)
    last |= static_cast<std::uint64_t>(octets[i]) << (8 * i);
  absorb(v, last);
  v[2] ^= 0xff;
  mix(v, 4);
  return v[0] ^ v[1] ^ v[2] ^ v[3];
}

udp_token udp_cookies::next_token() {
  const auto octets = byte_writer().octet(for_token).big(++tokens_).finish();
  return {std::max<std::uint64_t>(1, keyed_hash(secret_, octets))};
}

std::uint64_t udp_cookies::of_age(const udp_address& from, udp_token token,
                                  std::int64_t number) const {
  const auto octets = byte_writer()
                          .octet(for_cookie)
                          .big(number)
                          .append(from.ip)
                          .big(from.port)
                          .big(token.value)
                          .finish();
  return std::max<std::uint64_t>(1, keyed_hash(secret_, octets));
}

std::uint64_t udp_cookies::cookie(const udp_address& from, udp_token token, instant now) const {
  return of_age(from, token, now.time_since_epoch() / age);
}

bool udp_cookies::is_good(std::uint64_t cookie, const udp_address& from, udp_token token,
                          instant now) const {
  const auto number = now.time_since_epoch() / age;
  return cookie == of_age(from, token, number) || cookie == of_age(from, token, number - 1);
}

} // namespace rubicon::peis
