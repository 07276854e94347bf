// Access to tuples through meta tuples (docs/peis-wire.md 17, META-02, META-03).
#pragma once

#include <string_view>

#include "core/time.hpp"
#include "peis/kernel/kernel_layers.hpp"
#include "peis/kernel/tuple_commands.hpp"
#include "peis/kernel/tuple_reader.hpp"
#include "peis/tuples/meta_tuple.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

/// A meta tuple is a tuple like others, usually our own. Subscriptions through it are in
/// subscription_commands. Names in brackets are those of D1.1 3.1.3.
class meta_commands {
public:
  /// All outlive this.
  meta_commands(kernel_layers& layers, tuple_commands& tuples, tuple_reader& reader)
      : layers_(layers), tuples_(tuples), reader_(reader) {}

  /// [declareMetaTuple] Makes an own tuple a meta tuple that points nowhere, unless it is one
  /// already (META-03).
  [[nodiscard]] outputs declare(std::string_view key, instant now, request_id request = no_request);

  /// [setMetaTuple] Points a meta tuple, ours or another's, at a tuple. Abstract: the target is not
  /// one tuple.
  [[nodiscard]] outputs set_reference(peer_id meta_owner, std::string_view meta_key,
                                      peer_id target_owner, std::string_view target_key,
                                      request_id request, instant now);

  /// [isMetaTuple] Do we hold such a tuple, and does it say where it points (META-03)?
  [[nodiscard]] bool is_meta_tuple(peer_id owner, std::string_view key) const;

  /// [setTupleIndirectly] Sets what the meta tuple, as we hold it, points at. bad_meta_tuple if we
  /// hold none or it points nowhere.
  [[nodiscard]] outputs set_indirectly(peer_id meta_owner, std::string_view meta_key,
                                       tuple_content content, request_id request, instant now);

  /// [getTupleIndirectly] What the meta tuple, as we hold it, points at; nothing if it points
  /// nowhere. bad_meta_tuple if we hold none.
  [[nodiscard]] reading get_indirectly(peer_id meta_owner, std::string_view meta_key,
                                       read_mode mode, instant now);

private:
  [[nodiscard]] result<meta_reference> look_up(peer_id meta_owner, std::string_view meta_key,
                                               instant now);

  kernel_layers& layers_;
  tuple_commands& tuples_;
  tuple_reader& reader_;
};

} // namespace rubicon::peis
