#include "smepp/crypto/security.hpp"

#include <algorithm>
#include <cassert>

#include "core/codec.hpp"

namespace rubicon::smepp {

namespace {

struct header {
  std::uint8_t suite = 0;
  std::uint8_t key_number = 0;
  group_id group;
  std::uint64_t counter = 0;
};

header read_header(byte_reader& from) {
  header x;
  x.suite = from.octet();
  x.key_number = from.octet();
  x.group = group_id{from.big<std::uint16_t>()};
  x.counter = from.big<std::uint64_t>();
  return x;
}

/// The counter block of a frame's first 16 octets: uint16 sender, uint64 counter, zeros, and as the
/// last uint32 the number of the block.
block nonce(mote_id sender, std::uint64_t counter) {
  byte_writer x;
  x.big(sender.value).big(counter).zeros(6);
  block first{};
  std::ranges::copy(x.view(), first.begin());
  return first;
}

tag mac_of(const key& under, mote_id from, mote_id to, byte_view header_and_ciphertext) {
  byte_writer input;
  input.big(from.value).big(to.value).append(header_and_ciphertext);
  return short_mac(under, input.view());
}

std::uint8_t number_of(const key_pair& network) {
  return derive(network.integrity, "number").reveal().front();
}

std::uint8_t key_number(std::uint8_t network, std::uint16_t generation) {
  return static_cast<std::uint8_t>((network & 0xf) << 4 | (generation & 0xf));
}

} // namespace

std::string_view to_string(refusal x) {
  switch (x) {
  case refusal::malformed:
    return "malformed";
  case refusal::unknown_suite:
    return "unknown_suite";
  case refusal::unknown_group:
    return "unknown_group";
  case refusal::wrong_key:
    return "wrong_key";
  case refusal::tampered:
    return "tampered";
  case refusal::replayed:
    return "replayed";
  case refusal::unproven:
    return "unproven";
  }
  return "";
}

security::security(security_config config, std::uint64_t counter_reserved)
    : config_(config), counter_(counter_reserved), reserved_(counter_reserved),
      windows_(config.windows_max), sources_(config.sources_max) {
  assert(config.counter_block > 0);
}

void security::set_network_keys(const key_pair& x, instant now) {
  if (network_.size() > 1)
    network_.pop_back();
  if (!network_.empty())
    network_.front().until = now + config_.grace;
  network_.insert(network_.begin(), {x, number_of(x), std::nullopt});
  derive_all();
}

void security::set_group(group_id group, const std::vector<session_keys>& accepted) {
  assert(group != network_level);
  auto& known = groups_[group];
  std::vector<accepted_keys> now;
  for (const auto& x : accepted) {
    const auto found = std::ranges::find_if(
        known, [&](const accepted_keys& each) { return each.session.id == x.id; });
    now.push_back({x, found != known.end() ? found->order : ++newest_});
  }
  for (const auto& x : known)
    if (std::ranges::none_of(now, [&](const accepted_keys& y) { return y.order == x.order; }))
      windows_.forget(group, x.order);
  known = std::move(now);
  derive_all();
}

void security::remove_group(group_id group) {
  groups_.erase(group);
  windows_.forget(group);
  std::erase_if(asked_, [&](const asked& x) { return x.group == group; });
  derive_all();
}

void security::derive_all() {
  keys_.clear();
  for (const auto& network : network_) {
    keys_.push_back({network_level,
                     {},
                     0,
                     key_number(network.number, 0),
                     {derive(network.keys.confidentiality, "network"),
                      derive(network.keys.integrity, "network")}});
    for (const auto& [group, sessions] : groups_)
      for (const auto& x : sessions)
        keys_.push_back(
            {group,
             x.session.id,
             x.order,
             key_number(network.number, x.session.id.generation),
             {derive(network.keys.confidentiality, "group",
                     x.session.keys.confidentiality.reveal()),
              derive(network.keys.integrity, "group", x.session.keys.integrity.reveal())}});
  }
}

const security::frame_keys* security::sending_keys(group_id group, session_id session) const {
  const auto found = std::ranges::find_if(
      keys_, [&](const frame_keys& x) { return x.group == group && x.session == session; });
  return found == keys_.end() ? nullptr : &*found;
}

std::optional<std::uint64_t> security::unique() {
  if (counter_ >= config_.counter_end) {
    ++counters_.used_up;
    return std::nullopt;
  }
  if (counter_ == reserved_) {
    reserved_ += std::min<std::uint64_t>(config_.counter_block, config_.counter_end - reserved_);
    must_store_ = true;
  }
  return counter_++;
}

std::optional<std::uint64_t> security::take_store() {
  if (!must_store_)
    return std::nullopt;
  must_store_ = false;
  return reserved_;
}

result<bytes> security::seal(mote_id to, group_id group, session_id session, byte_view content) {
  const auto* const found = sending_keys(group, session);
  if (found == nullptr)
    return errc::unsupported;
  if (content.size() > message_max)
    return errc::too_long;
  const auto counter = unique();
  if (!counter)
    return errc::bad_value;
  byte_writer header;
  header.octet(static_cast<std::uint8_t>(suite::aes_ctr_cmac64))
      .octet(found->number)
      .big(group.value)
      .big(*counter)
      .append(content);
  auto octets = header.finish();
  apply_ctr(found->keys.confidentiality, nonce(config_.self, *counter),
            std::span(octets).subspan(secured_header_size));
  const auto mac = mac_of(found->keys.integrity, config_.self, to, octets);
  octets.insert(octets.end(), mac.begin(), mac.end());
  ++counters_.sealed;
  return octets;
}

opening security::open(mote_id from, mote_id to, byte_view octets, instant now) {
  on_time(now);
  group_id group;
  const auto refuse = [&](refusal why) {
    count(why);
    return refused_frame{why, group};
  };
  if (octets.size() < secured_overhead || octets.size() > network::frame_payload_max)
    return refuse(refusal::malformed);
  byte_reader reader(octets);
  const auto x = read_header(reader);
  group = x.group;
  if (x.suite != static_cast<std::uint8_t>(suite::aes_ctr_cmac64))
    return refuse(refusal::unknown_suite);
  const bool is_group = x.group != network_level;
  if (is_group && !groups_.contains(x.group))
    return refuse(refusal::unknown_group);
  unsigned tried = 0;
  auto why = refusal::wrong_key;
  for (const auto& keys : keys_) {
    if (keys.group != x.group || keys.number != x.key_number || tried == macs_max)
      continue;
    ++tried;
    auto result = try_keys(keys, from, to, octets, x.counter);
    if (auto* const opened = std::get_if<opened_frame>(&result)) {
      ++counters_.opened;
      return std::move(*opened);
    }
    if (why != refusal::tampered) // of one that might be the right pair
      why = std::get<refusal>(result);
  }
  auto refused = refuse(why);
  refused.is_ahead = is_group && why != refusal::replayed && is_ahead(x.group, x.key_number);
  return refused;
}

/// Opens a frame with one pair of keys.
std::variant<opened_frame, refusal> security::try_keys(const frame_keys& keys, mote_id from,
                                                       mote_id to, byte_view octets,
                                                       std::uint64_t counter) {
  using verdict = replay_windows::verdict;
  const auto judged = keys.group == network_level
                          ? verdict::unknown
                          : windows_.judge(from, keys.group, keys.order, counter);
  if (judged == verdict::replayed)
    return refusal::replayed;
  tag mac{};
  std::ranges::copy(octets.last(mac.size()), mac.begin());
  const auto covered = octets.first(octets.size() - mac.size());
  ++counters_.macs;
  if (!is_same(mac_of(keys.keys.integrity, from, to, covered), mac))
    return refusal::tampered;
  auto content = to_bytes(covered.subspan(secured_header_size));
  apply_ctr(keys.keys.confidentiality, nonce(from, counter), content);
  if (judged == verdict::fresh)
    windows_.accept(from, keys.group, keys.order, counter);
  return opened_frame{keys.group, keys.session, counter, std::move(content),
                      judged == verdict::fresh};
}

bool security::is_new_request(mote_id from, const opened_frame& frame, instant now) {
  if (sources_.is_old(from, frame.counter, now)) {
    count(refusal::replayed);
    return false;
  }
  sources_.note(from, frame.counter, now);
  return true;
}

bool security::is_ahead(group_id group, std::uint8_t number) const {
  const auto& sessions = groups_.at(group);
  if (sessions.empty() || network_.empty() || (network_.front().number & 0xf) != number >> 4)
    return false;
  const auto ahead = (number - sessions.front().session.id.generation) & 0xf;
  return ahead < 8;
}

std::optional<std::uint64_t> security::challenge(mote_id sender, group_id group, instant now) {
  std::erase_if(asked_, [&](const asked& x) { return x.at + config_.challenge_pause <= now; });
  const bool is_asked = std::ranges::any_of(
      asked_, [&](const asked& x) { return x.sender == sender && x.group == group; });
  if (is_asked || asked_.size() >= config_.challenges_max || !challenges_allowed_.take(now))
    return std::nullopt;
  const auto nonce = unique();
  if (!nonce)
    return std::nullopt;
  ++counters_.challenges;
  asked_.push_back({sender, group, *nonce, now});
  return nonce;
}

bool security::on_proof(mote_id sender, const opened_frame& frame, std::uint64_t nonce) {
  const auto found = std::ranges::find_if(asked_, [&](const asked& x) {
    return x.sender == sender && x.group == frame.group && x.nonce == nonce;
  });
  if (found == asked_.end())
    return false;
  asked_.erase(found);
  believe(sender, frame.group, frame.session, frame.counter);
  ++counters_.proofs;
  return true;
}

void security::believe(mote_id sender, group_id group, session_id under, std::uint64_t counter) {
  const auto& known = groups_.at(group);
  const auto found =
      std::ranges::find_if(known, [&](const accepted_keys& x) { return x.session.id == under; });
  if (found != known.end())
    windows_.begin(sender, group, found->order, newest_, counter);
}

void security::on_time(instant now) {
  if (std::erase_if(network_, [&](const network_pair& x) { return x.until && *x.until <= now; }) >
      0)
    derive_all();
}

std::optional<instant> security::deadline() const {
  std::optional<instant> first;
  for (const auto& x : network_)
    first = earliest(first, x.until);
  return first;
}

std::size_t security::footprint() const {
  // Derived keys can be computed when they are needed; a mote keeps those of the last frame.
  constexpr std::size_t two_pairs = key::size * 2 * 2;
  return two_pairs + windows_.footprint() + sources_.footprint() + proofs_allowed_.footprint() +
         config_.challenges_max * (2 + 2 + 8 + 4) + 16;
}

} // namespace rubicon::smepp
