#include "actors/peis/real_links.hpp"

#include <utility>

#include "actors/messages/common.hpp"
#include "actors/messages/links.hpp"
#include "actors/messages/peis.hpp"
#include "peis/wire/announcement.hpp"
#include "peis/wire/link_url.hpp"

namespace rubicon {

namespace {

constexpr std::size_t unknown_names_max = 100;

} // namespace

std::variant<std::unique_ptr<real_links>, std::string>
real_links::open(const real_links_config& config, peis_peer_actor user) {
  auto out = std::unique_ptr<real_links>(new real_links(config, std::move(user)));
  auto links = peer::tcp_links::open(*config.loop, config.links, *out);
  if (auto* why = std::get_if<std::string>(&links))
    return "cannot listen: " + *why;
  out->links_ = std::get<std::unique_ptr<peer::tcp_links>>(std::move(links));
  if (config.port_is_given && out->links_->port() != config.links.first_port)
    return "cannot listen: port " + std::to_string(*config.links.first_port) +
           " is in use: end the program that uses it, or give this peer another `tcp.port`";
  if (const auto why = out->links_->warning(); !why.empty())
    out->report_unmet(
        why + ": remove `lan` from the file, or connect this computer to a network with multicast");
  if (auto why = out->open_adapter(config); !why.empty())
    return why;
  return out;
}

/// @returns why not, if it cannot
std::string real_links::open_adapter(const real_links_config& config) {
  if (config.adapter.empty())
    return {};
  auto adapter = config.open_adapter(config.adapter);
  if (auto* why = std::get_if<std::string>(&adapter))
    return std::move(*why);
  peer::bluetooth_links_config x;
  x.adapter = config.adapter;
  x.inquiry = config.inquiry;
  x.first_link = peis::link_id{first_adapter_link};
  auto links = peer::bluetooth_links::open(
      *config.loop, std::move(x),
      std::get<std::unique_ptr<io::bluetooth_adapter>>(std::move(adapter)), *this, *this);
  if (auto* why = std::get_if<std::string>(&links))
    return std::move(*why);
  bluetooth_ = std::get<std::unique_ptr<peer::bluetooth_links>>(std::move(links));
  return {};
}

bool real_links::is_of_adapter(peis::link_id link) const {
  return bluetooth_ != nullptr && link.value >= first_adapter_link;
}

void real_links::carry_out(peis::to_link x) {
  if (is_of_adapter(x.link))
    bluetooth_->carry_out(x);
  else
    links_->carry_out(std::move(x));
}

void real_links::carry_out(const peis::close_link& x) {
  if (is_of_adapter(x.link))
    bluetooth_->carry_out(x);
  else
    links_->carry_out(x);
}

void real_links::carry_out(const peis::pace_link& x) {
  if (!is_of_adapter(x.link)) // each of its packages is sent as a whole
    links_->carry_out(x);
}

void real_links::carry_out(const peis::connect_to& x) {
  const auto url = peis::parse_link_url(x.url);
  if (bluetooth_ != nullptr && url && peis::bluetooth_device(*url))
    bluetooth_->carry_out(x);
  else
    links_->carry_out(x);
}

void real_links::carry_out(const peis::scan_adapter& x) {
  if (bluetooth_ != nullptr)
    bluetooth_->carry_out(x);
}

void real_links::carry_out(peis::say_hello x) {
  if (bluetooth_ == nullptr)
    return;
  auto octets = to_bytes(x.octets.view());
  peis::hide_inproc_of_announcement(octets);
  x.octets = std::move(octets);
  bluetooth_->carry_out(x);
}

void real_links::answer_hello(std::uint64_t connection, bytes octets) {
  peis::hide_inproc_of_announcement(octets);
  if (bluetooth_ != nullptr)
    bluetooth_->answer_hello(connection, std::move(octets));
}

void real_links::close_all() {
  links_->close_all();
  if (bluetooth_ != nullptr)
    bluetooth_->close_all();
}

std::vector<peis::low_level_address> real_links::addresses() const {
  auto all = links_->addresses();
  if (bluetooth_ == nullptr)
    return all;
  if (all.size() >= peis::low_level_addresses_max)
    all.resize(peis::low_level_addresses_max - 1);
  all.push_back(bluetooth_->address());
  return all;
}

void real_links::read(peis::link_id link, bool wanted) {
  const peis::read_link x{link, wanted};
  if (is_of_adapter(link))
    bluetooth_->carry_out(x);
  else
    links_->carry_out(x);
}

void real_links::on_scan(const std::string& adapter, const std::vector<peis::seen_device>& seen) {
  post(user_, bluetooth_seen{adapter, seen});
}

void real_links::on_hello(std::uint64_t number, byte_view octets) {
  post(user_, real_hello{number, to_bytes(octets)});
}

void real_links::on_hello_answer(const std::string& adapter, const peis::bluetooth_address& device,
                                 byte_view octets) {
  post(user_, hello_answer{adapter, device, to_bytes(octets)});
}

void real_links::on_link_open(peis::link_id link, peis::link_role role,
                              std::optional<peis::attempt_id> attempt) {
  post(user_,
       link_opened{
           link.value, {}, role == peis::link_role::initiator, attempt ? attempt->value : 0, {}});
}

void real_links::report_unmet(std::string what) {
  if (ecology_)
    post(ecology_, request_unmet{who_, std::move(what)});
}

/// That a peer is away is everyday; that no host has its name is a mistake in the file.
void real_links::on_attempt_failed(peis::attempt_id attempt, const std::string& why) {
  if (io::is_unknown_host(why) && unknown_names_.size() < unknown_names_max &&
      unknown_names_.insert(why).second)
    report_unmet("cannot connect to " + why + ": correct the name in `connect`");
  post(user_, attempt_failed{attempt.value});
}

void real_links::on_link_octets(peis::link_id link, byte_view octets) {
  read(link, false);
  post(user_, link_octets{link.value, to_bytes(octets)});
}

void real_links::on_taken(peis::link_id link) {
  if (!held_.contains(link))
    read(link, true);
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
