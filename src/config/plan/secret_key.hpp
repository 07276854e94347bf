// A key of SMEPP Light as a file has it.
#pragma once

#include <optional>
#include <string>

#include "config/toml/values.hpp"
#include "smepp/member_config.hpp"

namespace rubicon::config {

/// 128 bits as 32 hexadecimal digits. What is wrong is said without what was found.
struct secret_key {
  using type = smepp::key;
  std::string name; ///< as secrets_of() calls it

  [[nodiscard]] std::optional<smepp::key> read(const node& x, const asker& who) const;
  [[nodiscard]] static form takes();
};

} // namespace rubicon::config
