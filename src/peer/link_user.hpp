// The callbacks of the real links of a kernel.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "core/bytes.hpp"
#include "core/text/ipv4_network.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peer {

/// Is notified of what happens to links, on the loop's thread, never from within a call of
/// tcp_links or udp_links. Named like the kernel's inputs, which an owner passes it on to. May call
/// them, not destroy them.
class link_user {
public:
  virtual ~link_user() = default;
  virtual void on_link_open(peis::link_id link, peis::link_role role,
                            std::optional<peis::attempt_id> attempt) = 0;
  virtual void on_attempt_failed(peis::attempt_id attempt, const std::string& why) = 0;
  virtual void on_link_octets(peis::link_id link, byte_view octets) = 0; ///< valid in the call
  virtual void on_link_sent(peis::link_id link, std::size_t octets) = 0;
  virtual void on_link_closed(peis::link_id link, const std::string& why) = 0;
  /// @param datagram valid in the call
  virtual void on_announcement(byte_view datagram, const ipv4_address& from) = 0;
  virtual void on_addresses() = 0; ///< addresses() may be others than before
};

} // namespace rubicon::peer
