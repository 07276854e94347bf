// The options that peisinit, and scripts, give to original PEIS kernels: `--peis-id 7` and so on.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "config/plan/ecology.hpp"

namespace rubicon::cli {

/// Their values; unset: not given.
struct original_options {
  std::optional<peer_id> id;
  std::optional<std::uint16_t> port;
  std::vector<std::string> connect; ///< `tcp://HOST:PORT`
  std::optional<std::string> network;
  std::optional<std::string> name;
  std::optional<std::string> host_name;
  bool time_master = false;
  bool leaf = false;
  std::vector<std::string> without_effect; ///< as they were said
  std::vector<std::string> said;           ///< all words, those of files in place of --peis-load

  [[nodiscard]] bool any() const {
    return id || port || !connect.empty() || network || name || host_name || time_master || leaf;
  }
};

/// The text of a file of options; nullopt: it cannot be read.
using options_reader = std::function<std::optional<std::string>(const std::string& file)>;

/// Takes them out of the arguments, wherever they stand.
/// @returns why one of them is refused, if one is
[[nodiscard]] std::variant<original_options, std::string>
take_original_options(std::vector<std::string>& arguments, const options_reader& read);

/// Puts what they say in the place of what the file says of its peer: the only one, or the only
/// one with links to the real network.
/// @returns why it cannot be; empty: it is done
[[nodiscard]] std::string take_over(const original_options& x, config::ecology_description& to);

} // namespace rubicon::cli
