#include "smepp/security.hpp"

#include <algorithm>
#include <cassert>
#include <limits>

#include "core/codec.hpp"

namespace rubicon::smepp {

namespace {

constexpr auto last_counter = std::numeric_limits<std::uint32_t>::max();

struct header {
  std::uint8_t suite = 0;
  std::uint8_t key_number = 0;
  group_id group;
  std::uint32_t counter = 0;
};

header read_header(byte_reader& from) {
  header x;
  x.suite = from.octet();
  x.key_number = from.octet();
  x.group = group_id{from.big<std::uint16_t>()};
  x.counter = from.big<std::uint32_t>();
  return x;
}

/// The counter block of a frame's first 16 octets: uint16 sender, uint32 counter, zeros, and as the
/// last uint32 the number of the block.
block nonce(mote_id sender, std::uint32_t counter) {
  byte_writer x;
  x.big(sender.value).big(counter).zeros(10);
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

security::security(security_config config, std::uint32_t counter_reserved)
    : config_(config), counter_(counter_reserved), reserved_(counter_reserved),
      windows_(config.windows_max) {
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
  groups_[group] = accepted;
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
                     key_number(network.number, 0),
                     {derive(network.keys.confidentiality, "network"),
                      derive(network.keys.integrity, "network")}});
    for (const auto& [group, sessions] : groups_)
      for (const auto& x : sessions)
        keys_.push_back(
            {group,
             x.id,
             key_number(network.number, x.id.generation),
             {derive(network.keys.confidentiality, "group", x.keys.confidentiality.reveal()),
              derive(network.keys.integrity, "group", x.keys.integrity.reveal())}});
  }
}

const security::frame_keys* security::sending_keys(group_id group, session_id session) const {
  const auto found = std::ranges::find_if(
      keys_, [&](const frame_keys& x) { return x.group == group && x.session == session; });
  return found == keys_.end() ? nullptr : &*found;
}

std::uint32_t security::unique() {
  assert(counter_ != last_counter);
  if (counter_ == reserved_) {
    reserved_ += std::min(config_.counter_block, last_counter - reserved_);
    must_store_ = true;
  }
  return counter_++;
}

std::optional<std::uint32_t> security::take_store() {
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
  if (counter_ == last_counter) {
    ++counters_.used_up;
    return errc::bad_value;
  }
  const auto counter = unique();
  byte_writer header;
  header.octet(static_cast<std::uint8_t>(suite::aes_ctr_cmac64))
      .octet(found->number)
      .big(group.value)
      .big(counter)
      .append(content);
  auto octets = header.finish();
  apply_ctr(found->keys.confidentiality, nonce(config_.self, counter),
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
  const auto verdict =
      is_group ? windows_.judge(from, x.group, x.counter) : replay_windows::verdict::unknown;
  if (verdict == replay_windows::verdict::replayed)
    return refuse(refusal::replayed);

  tag mac{};
  std::ranges::copy(octets.last(mac.size()), mac.begin());
  const auto covered = octets.first(octets.size() - mac.size());
  unsigned tried = 0;
  for (const auto& keys : keys_) {
    if (keys.group != x.group || keys.number != x.key_number || tried == macs_max)
      continue;
    ++tried;
    ++counters_.macs;
    if (!is_same(mac_of(keys.keys.integrity, from, to, covered), mac))
      continue;
    auto content = to_bytes(covered.subspan(secured_header_size));
    apply_ctr(keys.keys.confidentiality, nonce(from, x.counter), content);
    const bool is_proven = verdict == replay_windows::verdict::fresh;
    if (is_proven)
      windows_.accept(from, x.group, x.counter);
    ++counters_.opened;
    return opened_frame{x.group, keys.session, x.counter, std::move(content), is_proven};
  }
  auto refused = refuse(tried == 0 ? refusal::wrong_key : refusal::tampered);
  refused.is_ahead = is_group && is_ahead(x.group, x.key_number);
  return refused;
}

bool security::is_ahead(group_id group, std::uint8_t number) const {
  const auto& sessions = groups_.at(group);
  if (sessions.empty() || network_.empty() || (network_.front().number & 0xf) != number >> 4)
    return false;
  const auto ahead = (number - sessions.front().id.generation) & 0xf;
  return ahead < 8;
}

std::optional<std::uint32_t> security::challenge(mote_id sender, group_id group, instant now) {
  if (counter_ == last_counter)
    return std::nullopt;
  std::erase_if(asked_, [&](const asked& x) { return x.at + config_.challenge_pause <= now; });
  const bool is_asked = std::ranges::any_of(
      asked_, [&](const asked& x) { return x.sender == sender && x.group == group; });
  if (is_asked || asked_.size() >= config_.challenges_max)
    return std::nullopt;
  ++counters_.challenges;
  asked_.push_back({sender, group, unique(), now});
  return asked_.back().nonce;
}

bool security::on_proof(mote_id sender, group_id group, std::uint32_t nonce,
                        std::uint32_t counter) {
  const auto found = std::ranges::find_if(asked_, [&](const asked& x) {
    return x.sender == sender && x.group == group && x.nonce == nonce;
  });
  if (found == asked_.end())
    return false;
  asked_.erase(found);
  windows_.begin(sender, group, counter);
  ++counters_.proofs;
  return true;
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
  return two_pairs + windows_.footprint() + config_.challenges_max * (2 + 2 + 4 + 4) + 8;
}

} // namespace rubicon::smepp
