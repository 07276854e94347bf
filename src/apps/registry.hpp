// Applications that a binary brings along: how files name them, and which keys they have
// (docs/applications.md).
#pragma once

#include <cassert>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/numbers/random.hpp"
#include "core/time.hpp"

namespace rubicon::apps {

class application;

/// Whole numbers are numbers too.
using setting = std::variant<double, bool, std::string, duration>;

/// A key of an application's table in a file.
struct setting_key {
  std::string name;
  setting otherwise;     ///< what it is if the file does not say; its type is the key's
  bool required = false; ///< the file must say
  double min = -1e12;    ///< of a number
  double max = 1e12;
  std::string meaning = {}; ///< one sentence, for the schema
};

/// What a file says, or `otherwise`, for each key.
class settings {
public:
  void set(const std::string& key, setting x);

  /// @pre the application's kind has such a key, of this type
  template <class T>
  [[nodiscard]] const T& get(std::string_view key) const {
    const auto found = values_.find(key);
    assert(found != values_.end());
    return std::get<T>(found->second);
  }

private:
  std::map<std::string, setting, std::less<>> values_;
};

struct application_kind {
  std::string name; ///< `app = "NAME"`; none of ours has it
  std::vector<setting_key> keys;
  /// Called once for each life of each application, so that no two share state.
  /// @param rng its own
  std::function<std::unique_ptr<application>(const settings& x, random_stream rng)> make;
  std::size_t streams = 0; ///< that it has open at most, of each sort
};

/// Kinds by name. A value: whoever loads files passes the one that it wants.
class registry {
public:
  /// @returns whether the name was free; otherwise nothing is changed
  bool add(application_kind x);

  [[nodiscard]] const auto& all() const { return kinds_; }

private:
  std::map<std::string, std::shared_ptr<const application_kind>> kinds_;
};

/// One of them, as a file has it.
struct custom_config {
  std::shared_ptr<const application_kind> kind; ///< not nullptr
  settings values;
};

} // namespace rubicon::apps
