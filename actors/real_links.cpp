#include "actors/real_links.hpp"

#include <utility>

#include "actors/messages/common.hpp"
#include "actors/messages/links.hpp"
#include "actors/messages/peis.hpp"

namespace rubicon {

namespace {

constexpr std::size_t unknown_names_max = 100;

} // namespace

std::variant<std::unique_ptr<real_links>, std::string>
real_links::open(const real_links_config& config, peis_peer_actor user) {
  auto out = std::unique_ptr<real_links>(new real_links(config, std::move(user)));
  auto links = peer::tcp_links::open(*config.loop, config.links, *out);
  if (auto* why = std::get_if<std::string>(&links))
    return std::move(*why);
  out->links_ = std::get<std::unique_ptr<peer::tcp_links>>(std::move(links));
  if (config.port_is_given && out->links_->port() != config.links.first_port)
    return "port " + std::to_string(*config.links.first_port) +
           " is in use: end the program that uses it, or give this peer another `tcp.port`";
  if (const auto why = out->links_->warning(); !why.empty())
    out->tell_unmet(
        why + ": remove `lan` from the file, or connect this computer to a network with multicast");
  return out;
}

void real_links::on_link_open(peis::link_id link, peis::link_role role,
                              std::optional<peis::attempt_id> attempt) {
  post(user_,
       link_opened{
           link.value, {}, role == peis::link_role::initiator, attempt ? attempt->value : 0, {}});
}

void real_links::tell_unmet(std::string what) {
  if (ecology_)
    post(ecology_, request_unmet{who_, std::move(what)});
}

/// That a peer is away is everyday; that nobody has its name is a mistake in the file.
void real_links::on_attempt_failed(peis::attempt_id attempt, const std::string& why) {
  if (io::is_unknown_host(why) && unknown_names_.size() < unknown_names_max &&
      unknown_names_.insert(why).second)
    tell_unmet("cannot connect to " + why + ": correct the name in `connect`");
  post(user_, attempt_failed{attempt.value});
}

void real_links::on_link_octets(peis::link_id link, byte_view octets) {
  links_->carry_out(peis::read_link{link, false});
  post(user_, link_octets{link.value, to_bytes(octets)});
}

void real_links::on_taken(peis::link_id link) {
  if (!held_.contains(link))
    links_->carry_out(peis::read_link{link, true});
}

void real_links::hold(peis::link_id link, bool held) {
  if (held)
    held_.insert(link);
  else if (held_.erase(link) > 0)
    on_taken(link);
}

void real_links::on_link_sent(peis::link_id link, std::size_t octets) {
  post(user_, link_sent{link.value, octets});
}

void real_links::on_link_closed(peis::link_id link, const std::string&) {
  held_.erase(link);
  post(user_, link_closed{link.value});
}

void real_links::on_announcement(byte_view datagram, const ipv4_address& from) {
  post(user_, announcement{to_bytes(datagram), from});
}

void real_links::on_addresses() {
  post(user_, addresses_changed{});
}

} // namespace rubicon
