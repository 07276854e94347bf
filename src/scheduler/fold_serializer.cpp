#include "scheduler/fold_serializer.hpp"

#include <bit>
#include <cstring>
#include <string_view>

namespace rubicon::scheduler {

namespace {

/// Up to eight octets, the first in the lowest bits, whatever the machine's byte order.
std::uint64_t word_at(const unsigned char* octets, std::size_t count) {
  std::uint64_t word = 0;
  for (std::size_t i = 0; i < count; ++i)
    word |= static_cast<std::uint64_t>(octets[i]) << (8 * i);
  return word;
}

} // namespace

caf::error fold_serializer::begin_object(std::uint16_t&, std::string& name) {
  into_.add(std::string_view(name));
  return caf::none;
}

caf::error fold_serializer::begin_sequence(std::size_t& size) {
  return fold(size);
}

caf::error fold_serializer::apply_raw(std::size_t size, void* data) {
  const auto* octets = static_cast<const unsigned char*>(data);
  into_.add(size);
  for (; size >= 8; size -= 8, octets += 8) {
    std::uint64_t word = 0;
    if constexpr (std::endian::native == std::endian::little)
      std::memcpy(&word, octets, 8);
    else
      word = word_at(octets, 8);
    into_.add(word);
  }
  if (size > 0)
    into_.add(word_at(octets, size));
  return caf::none;
}

caf::error fold_serializer::apply_impl(float& x) {
  return fold(std::bit_cast<std::uint32_t>(x));
}

caf::error fold_serializer::apply_impl(double& x) {
  return fold(std::bit_cast<std::uint64_t>(x));
}

caf::error fold_serializer::apply_impl(long double& x) {
  // Its bits differ between machines; two doubles hold what any of them can say.
  const auto head = static_cast<double>(x);
  const auto rest = static_cast<double>(x - head);
  fold(std::bit_cast<std::uint64_t>(head));
  return fold(std::bit_cast<std::uint64_t>(rest));
}

caf::error fold_serializer::apply_impl(std::string& x) {
  return apply_raw(x.size(), x.data());
}

caf::error fold_serializer::apply_impl(std::u16string& x) {
  fold(x.size());
  for (const auto c : x)
    fold(c);
  return caf::none;
}

caf::error fold_serializer::apply_impl(std::u32string& x) {
  fold(x.size());
  for (const auto c : x)
    fold(c);
  return caf::none;
}

} // namespace rubicon::scheduler
