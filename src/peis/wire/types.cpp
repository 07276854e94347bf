#include "peis/wire/types.hpp"

namespace rubicon::peis {

std::string_view to_string(cause x) {
  switch (x) {
  case cause::none:
    return "none";
  case cause::no_route:
    return "no_route";
  case cause::too_many_retries:
    return "too_many_retries";
  case cause::queue_full:
    return "queue_full";
  case cause::early_drop:
    return "early_drop";
  case cause::connection_dead:
    return "connection_dead";
  case cause::host_gone:
    return "host_gone";
  case cause::too_long:
    return "too_long";
  case cause::bad_port:
    return "bad_port";
  case cause::bad_key:
    return "bad_key";
  case cause::bad_value:
    return "bad_value";
  case cause::abstract:
    return "abstract";
  case cause::space_full:
    return "space_full";
  case cause::bad_handle:
    return "bad_handle";
  case cause::bad_index:
    return "bad_index";
  case cause::bad_meta_tuple:
    return "bad_meta_tuple";
  case cause::refused:
    return "refused";
  case cause::left:
    return "left";
  }
  return "unknown";
}

std::string_view to_string(close_cause x) {
  switch (x) {
  case close_cause::bad_stream:
    return "bad_stream";
  case close_cause::wrong_version:
    return "wrong_version";
  case close_cause::wrong_network:
    return "wrong_network";
  case close_cause::own_id:
    return "own_id";
  case close_cause::bad_id:
    return "bad_id";
  case close_cause::too_many_links:
    return "too_many_links";
  case close_cause::handshake_silent:
    return "handshake_silent";
  case close_cause::silent:
    return "silent";
  case close_cause::host_left:
    return "host_left";
  case close_cause::double_link:
    return "double_link";
  case close_cause::replaced:
    return "replaced";
  case close_cause::unneeded:
    return "unneeded";
  case close_cause::leaf:
    return "leaf";
  case close_cause::reborn:
    return "reborn";
  case close_cause::over_budget:
    return "over_budget";
  case close_cause::nameless:
    return "nameless";
  }
  return "unknown";
}

} // namespace rubicon::peis
