// The keys of tuples that an ecology has, as far as its file says.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "config/plan/ecology.hpp"
#include "proxy/classes/class_table.hpp"

namespace rubicon::config {

/// `*` stands for any one part, `**` at the end for any number of them.
struct known_key {
  std::string pattern;
  std::string owner; ///< name of a peer or gateway
};

/// Of gateways, proxies, readers of tags, goals, translations and bridges, in the order of their
/// owners' ids. What kernels and inits say about themselves is not among them.
[[nodiscard]] std::vector<known_key> tuple_keys(const ecology_description& x);

/// Whether a key, in which parts may be `*`, may be one of the pattern.
[[nodiscard]] bool may_be(std::string_view pattern, std::string_view key);

/// The class that claims a mote; nullptr: none.
[[nodiscard]] const proxy::proxy_class* class_of(const ecology_description& x, island_id island,
                                                 const mote_description& mote);

/// The same of many motes.
class mote_classes {
public:
  explicit mote_classes(const ecology_description& x);

  /// nullptr: no class claims the mote.
  [[nodiscard]] const proxy::proxy_class* of(const mote_description& mote);

private:
  const ecology_description& all_;
  proxy::class_table table_;
  std::map<std::uint32_t, const proxy::proxy_class*> known_; ///< by type
};

/// Names in braces stand for what is not known before the run: such parts of a key become `*`.
[[nodiscard]] std::string without_names(std::string_view text);

/// What the keys of a proxy begin with, of a mote of that island whose name is not known before the
/// run.
[[nodiscard]] std::string prefix_of_any(const proxy::proxy_class& what,
                                        const island_description& island);

/// Labels of motes that have a class, by what the keys of their proxies begin with, in lower case.
[[nodiscard]] std::map<std::string, std::string> object_labels(const ecology_description& x);

/// What the keys of a mote's proxy begin with.
[[nodiscard]] std::string prefix_of(const proxy::proxy_class& what,
                                    const island_description& island, const mote_description& mote);

} // namespace rubicon::config
