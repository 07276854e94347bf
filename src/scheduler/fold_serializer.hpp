// Folds a value into a hash by the way CAF would serialize it, without making octets of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include <caf/serializer.hpp>

#include "core/hash.hpp"

namespace rubicon::scheduler {

/// Every value that inspect() names is folded as 64-bit words: integers by value, floating-point
/// numbers by their bits, texts and raw octets by length and content, sequences by length and
/// elements.
class fold_serializer final : public caf::serializer {
public:
  /// @param into must outlive the serializer
  explicit fold_serializer(fold64& into) : into_(into) {}

  caf::error begin_object(std::uint16_t& number, std::string& name) override;
  caf::error end_object() override { return caf::none; }
  caf::error begin_sequence(std::size_t& size) override;
  caf::error end_sequence() override { return caf::none; }
  caf::error apply_raw(std::size_t size, void* data) override;

protected:
  caf::error apply_impl(std::int8_t& x) override { return fold(x); }
  caf::error apply_impl(std::uint8_t& x) override { return fold(x); }
  caf::error apply_impl(std::int16_t& x) override { return fold(x); }
  caf::error apply_impl(std::uint16_t& x) override { return fold(x); }
  caf::error apply_impl(std::int32_t& x) override { return fold(x); }
  caf::error apply_impl(std::uint32_t& x) override { return fold(x); }
  caf::error apply_impl(std::int64_t& x) override { return fold(x); }
  caf::error apply_impl(std::uint64_t& x) override { return fold(x); }
  caf::error apply_impl(float& x) override;
  caf::error apply_impl(double& x) override;
  caf::error apply_impl(long double& x) override;
  caf::error apply_impl(std::string& x) override;
  caf::error apply_impl(std::u16string& x) override;
  caf::error apply_impl(std::u32string& x) override;

private:
  template <class T>
  caf::error fold(T x) {
    into_.add(static_cast<std::uint64_t>(x));
    return caf::none;
  }

  fold64& into_;
};

} // namespace rubicon::scheduler
