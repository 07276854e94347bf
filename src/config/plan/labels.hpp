// Labels: what people call islands, motes, peers and proxies, beside the names of which keys and
// paths are made.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>

namespace rubicon::config {

inline constexpr std::size_t label_octets_max = 100;

/// All labels of a file, by the names of what they are for. They are text for people only: nothing
/// is looked up by a label.
class label_table {
public:
  enum class kind : std::uint8_t {
    island,
    mote, ///< by `ISLAND/MOTE`
    peer,
    proxy, ///< by the name of the class
  };

  /// An empty label is none.
  void add(kind what, const std::string& name, const std::string& label) {
    if (!label.empty())
      labels_[key_of(what, name)] = label;
  }

  /// Empty if there is none.
  [[nodiscard]] std::string of(kind what, std::string_view name) const {
    const auto found = labels_.find(key_of(what, name));
    return found == labels_.end() ? std::string() : found->second;
  }

  /// `fan (Lüfter / Küche)`; the name alone if there is no label.
  [[nodiscard]] std::string with_name(kind what, const std::string& name) const {
    const auto label = of(what, name);
    return label.empty() ? name : name + " (" + label + ')';
  }

  [[nodiscard]] bool empty() const { return labels_.empty(); }

  friend bool operator==(const label_table&, const label_table&) = default;

private:
  [[nodiscard]] static std::string key_of(kind what, std::string_view name) {
    return static_cast<char>('0' + static_cast<int>(what)) + std::string(name);
  }

  std::map<std::string, std::string, std::less<>> labels_; ///< by kind and name
};

} // namespace rubicon::config
