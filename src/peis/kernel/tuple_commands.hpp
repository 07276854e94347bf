// How the owner of a kernel writes tuples: its own, and those of other peers.
#pragma once

#include <string_view>

#include "core/bytes.hpp"
#include "core/time.hpp"
#include "peis/kernel/kernel_layers.hpp"
#include "peis/kernel/kernel_turn.hpp"
#include "peis/tuples/tuple.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

/// Names in brackets are those of D1.1 3.1.3. Outcomes of what is decided here come at once; each
/// command may end with bad_key, bad_value, too_long or left.
class tuple_commands {
public:
  /// @param layers outlive this
  explicit tuple_commands(kernel_layers& layers) : layers_(layers) {}

  /// [setTuple] Creates or updates an own tuple and pushes it to its subscribers (TUP-04). Also
  /// space_full; abstract without MIME type.
  [[nodiscard]] outputs set(std::string_view key, tuple_content content, instant now,
                            request_id request = no_request);

  /// [insertTuple, after initTuple and setTupleName] The same with all fields: owner, key, value,
  /// MIME type, encoding, user time and expiry of `draft` count; the rest is filled in. Another
  /// owner is asked as by set_remote(). Abstract if any of these is a wildcard (TUP-06).
  [[nodiscard]] outputs insert(tuple draft, instant now, request_id request = no_request);

  /// [appendTupleByAbstract] Adds to the value of each existing tuple that matches (TUP-07): of
  /// ours here, of others by asking the owner, or with any_peer all known hosts. Text gets its
  /// trailing NUL if `added` has none. The outcome says for one other owner that it has
  /// acknowledged, else whether it was accepted here; a prototype with a MIME type can be used for
  /// our own tuples only (bad_value), since the request cannot carry it.
  [[nodiscard]] outputs append(const prototype& wanted, payload added, instant now,
                               request_id request = no_request);

  /// Removes an own tuple here and at its subscribers (TUP-16); succeeds if there is none.
  [[nodiscard]] outputs remove(std::string_view key, instant now, request_id request = no_request);

  /// [setRemoteTuple] Asks `owner` to set (TUP-05) or delete one of its tuples. The outcome says
  /// whether the owner has acknowledged the request; a real kernel may still have refused it
  /// (docs/peis-wire.md 15.3). An owner without route fails at once (API-02). Our own id: locally.
  [[nodiscard]] outputs set_remote(peer_id owner, std::string_view key, tuple_content content,
                                   request_id request, instant now);
  [[nodiscard]] outputs remove_remote(peer_id owner, std::string_view key, request_id request,
                                      instant now);

private:
  [[nodiscard]] cause refusal_of_owner(peer_id owner, const key& name, bool quits) const;
  void expect_quit(const tuple& asked, request_id request);

  kernel_layers& layers_;
};

} // namespace rubicon::peis
