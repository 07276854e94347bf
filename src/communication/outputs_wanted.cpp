#include "communication/outputs_wanted.hpp"

#include <algorithm>
#include <cassert>

#include "core/codec.hpp"

namespace rubicon::communication {

namespace {

constexpr std::size_t entry_size = sizeof(std::uint16_t) + sizeof(std::uint32_t);

} // namespace

std::optional<output_wanted> wanted_on(std::span<const output_wanted> all, std::uint16_t channel) {
  for (const auto candidate : {channel, any_channel}) {
    const auto found = std::ranges::find(all, candidate, &output_wanted::channel);
    if (found != all.end())
      return *found;
  }
  return std::nullopt;
}

bytes encode(const std::vector<output_wanted>& x) {
  assert(x.size() <= outputs_wanted_max);
  byte_writer out;
  for (const auto& [channel, period] : x)
    out.big(channel).big(static_cast<std::uint32_t>(period.count()));
  return out.finish();
}

result<std::vector<output_wanted>> decode_outputs_wanted(byte_view octets) {
  if (octets.size() % entry_size != 0)
    return errc::truncated;
  if (octets.size() > entry_size * outputs_wanted_max)
    return errc::too_long;
  std::vector<output_wanted> all;
  byte_reader in(octets);
  while (in.remaining() > 0) {
    output_wanted x;
    x.channel = in.big<std::uint16_t>();
    x.period = std::chrono::milliseconds(in.big<std::uint32_t>());
    all.push_back(x);
  }
  return all;
}

} // namespace rubicon::communication
