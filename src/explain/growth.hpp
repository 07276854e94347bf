// For files of this room only: what is known of a record so far, and which step each of its numbers
// stands for.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <tuple>

#include "explain/traces.hpp"

namespace rubicon::explain {

/// What some octets carry.
struct sighting {
  subject about;
  cargo of = cargo::content;
  std::string kind = {}; ///< of an answer
};

/// One hop of one subject.
struct crossing {
  sighting what;
  medium over = medium::none;
  std::string from;
  std::string to;
  peer_id towards = any_peer;
  std::uint32_t fragments = 1;
};

/// Paths as they grow. Every record has a number and names the number of its cause: a step comes
/// after the step that the nearest of its causes stands for.
class growth {
public:
  explicit growth(const header& about);

  /// @pre what causes it has been noted
  void note(const record& r);

  /// From now on what `number` causes comes after this step.
  void stands_for(std::uint64_t number, node_index n) { steps_[number] = n; }

  /// The step that a number or the nearest of its causes stands for; no_node: none of them does.
  [[nodiscard]] node_index step_of(std::uint64_t number) const;

  /// The step that this number itself stands for; no_node: none.
  [[nodiscard]] node_index own_step_of(std::uint64_t number) const;

  /// The nearest cause that has begun so (kind::begun) and stands for no step yet; 0: none before
  /// the nearest that does.
  [[nodiscard]] std::uint64_t begun(std::uint64_t number, std::string_view what) const;

  node_index add(node x, node_index parent);

  /// The hop that `r` is part of: a new one, or, if the same has led to it, one that was tried
  /// before or of which it is another fragment.
  node_index hop_for(const crossing& x, std::uint64_t cause, const record& r);

  /// One of the fragments of a hop is there.
  void arrive(node_index n, std::uint32_t fragment, const std::string& actor, const record& r);

  [[nodiscard]] bool is_about_message(node_index n) const {
    return n != no_node && !all.nodes[n].about.is_tuple;
  }
  [[nodiscard]] node& at(node_index n) { return all.nodes[n]; }

  traces all;

private:
  void deliver(const node& x, const std::string& actor, instant when);
  [[nodiscard]] std::vector<node_index>& nodes_of(subject x);

  struct origin {
    std::uint64_t cause = 0;
    std::string begun; ///< what; empty: nothing
  };
  /// What has led to a hop, and between whom it is.
  using hop_key = std::tuple<std::uint64_t, medium, cargo, std::string, std::string, peer_id>;

  std::map<std::uint64_t, origin> origins_;
  std::map<std::uint64_t, node_index> steps_;
  std::map<hop_key, node_index> hops_;
  std::map<node_index, std::map<std::uint32_t, bool>> fragments_; ///< of hops: has it arrived?
};

} // namespace rubicon::explain
