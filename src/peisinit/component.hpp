// A component of a host, as configured for its peisinit (SVC-02).
#pragma once

#include <cstdint>
#include <string>

#include "core/address.hpp"
#include "core/time.hpp"

namespace rubicon::peisinit {

/// Either a peer of this process, or a command that becomes a process of its own.
struct component {
  std::string name;         ///< a part of tuple keys; no other component of the host has it
  peer_id id;               ///< under which its kernel is, or is asked to be, in the PEIS network
  std::string peer;         ///< name of the peer; empty: it is a command
  std::string command = {}; ///< for /bin/sh
  bool on = true;           ///< when its peisinit starts
  duration delay = 3s;      ///< from an unrequested end to the next start
  std::string semantics = {};
  std::string proxy = {};
  std::string arguments = {}; ///< follow the options of the kernel, see options_for()
};

/// What a component has to know of the kernel that carries its traffic (LEA-02).
struct host_facts {
  std::string name;
  std::string network;    ///< network string
  std::uint16_t port = 0; ///< where the kernel of the peisinit takes TCP links; 0: nowhere
};

/// The options that a component's kernel finds in the environment variable PEISINIT
/// (docs/peis.md, Started as a G6 kernel): `--peis-id 31 --peis-hostname pc --peis-network rubicon
/// --peis-connect tcp://localhost:8000`, and the extra arguments.
[[nodiscard]] std::string options_for(const component& x, const std::string& arguments,
                                      const host_facts& host);

} // namespace rubicon::peisinit
