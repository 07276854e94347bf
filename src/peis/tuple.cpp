#include "peis/tuple.hpp"

#include <utility>

namespace rubicon::peis {

tuple_content text_content(std::string_view text, std::optional<instant> expiry) {
  auto octets = to_bytes(text);
  octets.push_back(0);
  return {std::move(octets), std::string(text_mimetype), encoding::text, expiry};
}

tuple_content binary_content(payload octets, std::optional<instant> expiry) {
  return {std::move(octets), std::string(binary_mimetype), encoding::binary, expiry};
}

std::string_view tuple::text() const {
  const auto octets = value.view();
  const std::string_view all(reinterpret_cast<const char*>(octets.data()), octets.size());
  return all.substr(0, all.find('\0'));
}

} // namespace rubicon::peis
