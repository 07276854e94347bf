// Which host of a file runs what, and what one host's part of an ecology is (GEN-05, GEN-07).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "config/plan/ecology.hpp"

namespace rubicon::config {

/// The host of what names `host`: the first of the file if that is empty; empty if there is none.
[[nodiscard]] std::string host_of(const ecology_description& all, const std::string& host);

/// The same of an island or a peer.
template <class Placed>
[[nodiscard]] std::string host_of(const ecology_description& all, const Placed& x) {
  return host_of(all, x.host);
}

/// The hosts that run something, in the order of the file.
[[nodiscard]] std::vector<host_description> used_hosts(const ecology_description& all);

/// nullptr: there is no host of that name.
[[nodiscard]] const host_description* find_host(const ecology_description& all,
                                                std::string_view name);

/// What cannot be spread over hosts as the file has it. In one process it can run all the same.
[[nodiscard]] std::vector<std::string> placement_problems(const ecology_description& all);

/// The hosts that a fault is about, in the order of the file. One that draws its victim does so
/// on each of several hosts, among what is there.
[[nodiscard]] std::vector<std::string> hosts_of(const ecology_description& all, const fault& x);

/// What one host runs, in wall time: its islands and peers, their faults, and the expectations that
/// it can judge alone. If it is not the only one it has a peer more, of its own: that keeps PEIS
/// links over TCP with those of the other hosts, each of which is at `peis_port` of its address,
/// and stands in for all peers of other hosts to whom a peer here has a link (LEA-02).
/// @pre the host is a used one, and there are no placement_problems
[[nodiscard]] ecology_description part_of(const ecology_description& all, const std::string& host);

/// The peer of that kind; nullptr in an ecology that is in one place. @param part as part_of makes
[[nodiscard]] const peer_description* host_peer(const ecology_description& part);

/// What is left of a part when it begins anew in the middle of its run: its end, the times of its
/// faults, the time of day, readings and whatever moves are as if it had run until then.
/// @pre elapsed < part.length
void begin_later(ecology_description& part, duration elapsed);

} // namespace rubicon::config
