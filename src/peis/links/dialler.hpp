// Links that are asked for: to addresses that are always kept, and to hosts (A9, AUT-01, TCP-07).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "peis/bluetooth/bluetooth.hpp"
#include "peis/links/contact_history.hpp"
#include "peis/overlay/host_table.hpp"
#include "peis/overlay/link_table.hpp"
#include "peis/overlay/occasion.hpp"
#include "peis/overlay/overlay.hpp"
#include "peis/overlay/own_peer.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

/// A link that has been asked for.
struct attempt {
  std::uint32_t flags = 0;
  std::optional<peer_id> host;
  std::optional<std::size_t> standing; ///< index of the address that is kept
  instant deadline;
  bool loopback = false; ///< the address is one of this computer
};

///   asked for --take()--> link opens
///       |
///       +-- failed or late: an address that is kept is tried again
class dialler {
public:
  /// All outlive this.
  dialler(own_peer& own, const link_table& links, const overlay& routes, const host_table& hosts,
          contact_history& contacts, const bluetooth& adapters, instant now);

  /// Over one of its addresses that can be reached from here, at random. @returns false if there is
  /// none, or no room for a link
  bool connect(const host_record& record, std::uint32_t flags, const occasion& x);
  /// Another link to the neighbour of this one.
  void connect_beside(const connection& x, const host_record& record, const occasion& at);
  [[nodiscard]] std::vector<std::string> urls_to(const host_record& other) const;
  /// It has addresses, but none in the listed networks.
  [[nodiscard]] bool may_dial_none(const host_record& x) const;
  [[nodiscard]] bool may_try(peer_id host, unsigned wait_max, instant now);
  [[nodiscard]] bool is_seeking(peer_id host) const;

  /// A link has opened. @returns its attempt; nothing if it was too late
  [[nodiscard]] std::optional<attempt> take(attempt_id id);
  void on_opened(const attempt& x, link_id link);
  void on_attempt_failed(attempt_id id, instant now);

  // Links of addresses that are kept.
  /// Which address the link is of.
  [[nodiscard]] std::optional<std::size_t> standing_of(link_id link) const;
  /// The peer at its other end has described itself, or others (`cached`).
  void on_record(const connection& x, const host_record& record, bool own_word, bool cached,
                 instant now);
  void on_link_closed(link_id link, instant now);
  /// The other end has closed a link: at once, or one that had lasted.
  void note_end(std::size_t standing, bool refused, bool lasted, instant now);

  void abandon();            ///< all attempts
  void on_time(instant now); ///< ends attempts that are late
  void dial_standing(const occasion& x);
  [[nodiscard]] std::optional<instant> deadline() const;

private:
  /// An address to which a link is always kept, or that is asked for others.
  struct standing_address {
    std::string url;
    bool seed = false;
    duration wait; ///< before the next try
    instant next;  ///< try
    bool trying = false;
    std::optional<link_id> link;
    std::optional<peer_id> host; ///< who answered there last
    unsigned refusals = 0;       ///< links that were closed at once, one after the other
    bool elsewhere = false;      ///< the next try is at another address of its host
  };

  void dial(const std::string& url, attempt x, const occasion& at);
  void end(const attempt& x, bool success, instant now);
  [[nodiscard]] bool is_served(const standing_address& x) const;
  [[nodiscard]] std::optional<std::string> other_address(const standing_address& x);
  [[nodiscard]] bool may_dial(const low_level_address& x) const;

  own_peer& own_;
  const link_table& links_;
  const overlay& overlay_;
  const host_table& hosts_;
  contact_history& contacts_;
  const bluetooth& adapters_;
  std::uint64_t next_attempt_ = 1;
  std::map<attempt_id, attempt> attempts_;
  std::vector<standing_address> standing_;
};

} // namespace rubicon::peis
