// Actor paths, addresses and peers as a person knows them from the file.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "core/address.hpp"
#include "explain/record.hpp"

namespace rubicon::explain {

class names {
public:
  names() = default;
  explicit names(const header& about);

  /// `kitchen/climate-7`, `kitchen/sink`, `kitchen/gateway`, `care-pc`; numbers for what the header
  /// does not name.
  [[nodiscard]] std::string of(mote_address x) const;
  [[nodiscard]] std::string of(peer_id x) const;

  /// Of an actor: `mote/kitchen/fan` is `kitchen/fan`, `proxy/kitchen.fan` is `proxy kitchen.fan`.
  [[nodiscard]] static std::string of(std::string_view path);

  /// The mote, sink (as a mote) or gateway (as its island's no_mote) that an actor is; nothing for
  /// others. A PC is the no_mote of the island with its peer's id.
  [[nodiscard]] std::optional<mote_address> address_of(std::string_view path) const;

  /// The actor at an address; empty if the header does not name it.
  [[nodiscard]] std::string path_of(mote_address x) const;

  /// The gateway at a serial line's end. @param line path of its actor
  [[nodiscard]] std::string gateway_at(std::string_view line, island_id island) const;

  /// Where an actor is: gateways and PCs are where their kernels are.
  [[nodiscard]] std::string place_of(const std::string& path) const;

  /// The actor that is a peer's kernel.
  [[nodiscard]] static std::string kernel_path(const std::string& peer_name) {
    return "peis_peer/" + peer_name;
  }

  /// Of an actor that is a PEIS kernel.
  [[nodiscard]] std::optional<peer_id> peer_of(std::string_view path) const;

  /// The gateway with the island's id, for any other gateway of it; others speak for themselves.
  [[nodiscard]] peer_id speaks_for(peer_id x) const;

  /// @returns the id that sinks have by default for an island the header does not name
  [[nodiscard]] mote_id sink_of(island_id x) const;

private:
  std::map<mote_address, std::string> motes_;
  std::map<std::string, mote_address, std::less<>> actors_;
  std::map<std::string, peer_id, std::less<>> kernels_;
  std::map<peer_id, std::string> peers_;
  std::map<mote_address, std::string> paths_;
  std::map<std::string, std::string> places_;
  std::map<island_id, mote_id> sinks_;
  std::map<peer_id, peer_id> speaks_for_;
};

} // namespace rubicon::explain
