// For files of this room only: the system, and the messages that it knows.
#pragma once

#include <caf/all.hpp>
#include <caf/io/all.hpp>
#include <caf/openssl/all.hpp>

#include "control/inspect.hpp"
#include "control/system.hpp"
#include "deploy/messages.hpp"

CAF_BEGIN_TYPE_ID_BLOCK(rubicon_control, caf::first_custom_type_id + 1000)
CAF_ADD_TYPE_ID(rubicon_control, (rubicon::deploy::greeting))
CAF_ADD_TYPE_ID(rubicon_control, (rubicon::deploy::ask_facts))
CAF_ADD_TYPE_ID(rubicon_control, (rubicon::deploy::host_facts))
CAF_ADD_TYPE_ID(rubicon_control, (rubicon::deploy::offer))
CAF_ADD_TYPE_ID(rubicon_control, (rubicon::deploy::verdict))
CAF_ADD_TYPE_ID(rubicon_control, (rubicon::deploy::begin_part))
CAF_ADD_TYPE_ID(rubicon_control, (rubicon::deploy::end_part))
CAF_ADD_TYPE_ID(rubicon_control, (rubicon::deploy::cause_fault))
CAF_ADD_TYPE_ID(rubicon_control, (rubicon::deploy::ask_news))
CAF_ADD_TYPE_ID(rubicon_control, (rubicon::deploy::news))
CAF_ADD_TYPE_ID(rubicon_control, (rubicon::deploy::offer_seeds))
CAF_ADD_TYPE_ID(rubicon_control, (rubicon::deploy::run_seeds))
CAF_ADD_TYPE_ID(rubicon_control, (rubicon::deploy::seeds_news))
CAF_END_TYPE_ID_BLOCK(rubicon_control)

namespace rubicon::control {

struct settings : caf::actor_system_config {
  /// @throws std::runtime_error if a file of `tls` cannot be used
  explicit settings(const tls_files& tls);
};

struct system::impl {
  explicit impl(const tls_files& tls) : all(tls), actors(all), is_secured(!tls.empty()) {}

  settings all; ///< the system looks into it to its end
  caf::actor_system actors;
  const bool is_secured;

  /// Who opens and takes connections.
  [[nodiscard]] caf::io::middleman_actor manager() {
    return is_secured ? actors.openssl_manager().actor_handle() : actors.middleman().actor_handle();
  }
};

} // namespace rubicon::control
