#include <set>
#include <sstream>
#include <type_traits>

#include "core/numbers/random.hpp"
#include "smepp/crypto/agreement.hpp"
#include "smepp/crypto/handshake.hpp"
#include "smepp/crypto/security.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::smepp;

namespace {

key key_of(std::string_view hex) {
  return *key::from_hex(hex);
}

key key_number(std::uint8_t x) {
  std::array<std::uint8_t, key::size> octets{};
  octets.fill(x);
  return key(octets);
}

const key_pair network_keys{key_number(1), key_number(2)};
const session_keys first_session{{1, mote_id{1}}, {key_number(3), key_number(4)}};
const session_keys second_session{{2, mote_id{1}}, {key_number(5), key_number(6)}};
constexpr group_id group{77};
constexpr mote_id alice{1};
constexpr mote_id bob{2};

security peer(mote_id self, std::uint64_t reserved = 0) {
  security_config config;
  config.self = self;
  security x(config, reserved);
  x.set_network_keys(network_keys, instant{});
  x.set_group(group, {first_session});
  return x;
}

bytes seal(security& from, std::string_view text, mote_id to = broadcast_mote,
           session_id session = first_session.id) {
  const auto frame = from.seal(to, group, session, to_bytes(text));
  REQUIRE(frame);
  return *frame;
}

/// The text, or why there is none.
std::string open(security& at, mote_id from, byte_view frame, mote_id to = broadcast_mote,
                 instant now = {}) {
  const auto x = at.open(from, to, frame, now);
  if (const auto* const refused = std::get_if<refused_frame>(&x))
    return std::string(to_string(refused->why));
  const auto& opened = std::get<opened_frame>(x);
  return (opened.is_proven ? "" : "unproven ") + to_string(byte_view(opened.content));
}

template <class T>
concept printable_type = requires(std::ostream& out, const T& x) {
  out << x;
};
template <class T>
concept has_text = requires(const T& x) {
  to_string(x);
};

} // namespace

TEST_CASE("AES-128 in counter mode gives NIST's ciphertexts", "[smepp][SMP-03]") {
  // NIST SP 800-38A F.5.1
  auto octets = *from_hex("6bc1bee22e409f96e93d7e117393172aae2d8a571e03ac9c9eb76fac45af8e51"
                          "30c81c46a35ce411e5fbc1191a0a52eff69f2445df4f9b17ad2b417be66c3710");
  const auto plain = octets;
  block first{};
  std::ranges::copy(*from_hex("f0f1f2f3f4f5f6f7f8f9fafbfcfdfeff"), first.begin());
  const auto under = key_of("2b7e151628aed2a6abf7158809cf4f3c");
  apply_ctr(under, first, octets);
  CHECK(to_hex(octets) == "874d6191b620e3261bef6864990db6ce9806f66b7970fdff8617187bb9fffdff"
                          "5ae4df3edbd5d35e5b4f09020db03eab1e031dda2fbe03d1792170a0f3009cee");
  apply_ctr(under, first, octets);
  CHECK(octets == plain);
}

TEST_CASE("CMAC gives the tags of RFC 4493", "[smepp][SMP-03]") {
  const auto under = key_of("2b7e151628aed2a6abf7158809cf4f3c");
  const auto text = *from_hex("6bc1bee22e409f96e93d7e117393172aae2d8a571e03ac9c9eb76fac45af8e51"
                              "30c81c46a35ce411e5fbc1191a0a52eff69f2445df4f9b17ad2b417be66c3710");
  const auto mac_of_first = [&](std::size_t size) {
    return to_hex(cmac(under, byte_view(text).first(size)));
  };
  CHECK(mac_of_first(0) == "bb1d6929e95937287fa37d129b756746");
  CHECK(mac_of_first(16) == "070a16b46b4d4144f79bdd9dd04a287c");
  CHECK(mac_of_first(40) == "dfa66747de9ae63030ca32611497c827");
  CHECK(mac_of_first(64) == "51f0bebf7e3b9d92fc49741779363cfe");
  CHECK(to_hex(short_mac(under, text)) == "51f0bebf7e3b9d92");
}

TEST_CASE("two agree on the secret of RFC 7748", "[smepp][SMP-09]") {
  const auto octets_of = [](std::string_view hex) {
    std::array<std::uint8_t, 32> x{};
    std::ranges::copy(*from_hex(hex), x.begin());
    return x;
  };
  // RFC 7748 6.1
  const agreement a(octets_of("77076d0a7318a57d3c16c17251b26645df4c2f87ebc0992ab177fba51db92c2a"));
  const agreement b(octets_of("5dab087e624a8a4b79e17f8b83800ee66f3bb1292618b6fd1c2f8b27ff88e0eb"));
  CHECK(to_hex(a.share()) == "8520f0098930a754748b7ddcb43ef75a0dbf3a0d26381af4eba4a98eaa9b4e6a");
  CHECK(to_hex(b.share()) == "de9edb7d7b7dc1b4d35b61c2ece435373f8343c85b78674dadfc7e146f882b4f");
  CHECK(to_hex(*a.shared_secret(b.share())) ==
        "4a5d9d5ba4ce2de1728e3bf480350f25e07e21c947d19e3376f09b3c1e161742");
  CHECK(*a.agree(b.share()) == *b.agree(a.share()));
  // RFC 5869: HKDF-SHA-256 of it, without salt, info "agreed"
  CHECK(*a.agree(b.share()) == key_of("ec4393b81ac3f11006a5be09a4357500"));
  CHECK_FALSE(a.agree(key_share{})); // of low order
  randomness secrets(random_stream(1));
  CHECK_FALSE(*agreement::make(secrets).agree(b.share()) == *a.agree(b.share()));
}

TEST_CASE("session keys open for who has agreed on them only", "[smepp][SMP-09][SMP-13]") {
  randomness secrets(random_stream(2));
  const auto credential = key_number(9);
  const auto joiner = agreement::make(secrets);
  const auto identity = agreement::make(secrets);
  const auto member = agreement::make(secrets);
  const join_proof said{
      .group = group, .nonce = 1, .share = joiner.share(), .identity = identity.share()};
  const handshake with{alice, bob, said, member.share(),
                       terms_of({.name = "kitchen", .master = credential, .is_closed = true})};
  const auto agreed = *joiner.agree(member.share());
  const auto as_itself = *identity.agree(member.share());
  const bytes carrier{1, 2, 3};
  const auto wrapped =
      wrap(accept_key(credential, with, agreed, as_itself), second_session, 5s, carrier);
  CHECK(wrapped.send_in_ms == 5000);
  const auto made =
      accept_key(credential, with, *member.agree(joiner.share()), *member.agree(identity.share()));
  const auto opened = unwrap(made, wrapped, carrier);
  REQUIRE(opened);
  CHECK(opened->id == second_session.id);
  CHECK(opened->keys == second_session.keys);
  CHECK_FALSE(unwrap(made, wrapped, bytes{1, 2, 4}));
  // Who has recorded it all and has the credential, now or later, or claims to be another:
  const auto other = agreement::make(secrets);
  const auto opens = [&](const key& credential_, const handshake& with_, const key& agreed_,
                         const key& identity_) {
    return unwrap(accept_key(credential_, with_, agreed_, identity_), wrapped, carrier).has_value();
  };
  CHECK_FALSE(opens(credential, with, *other.agree(member.share()), as_itself));
  CHECK_FALSE(opens(credential, with, agreed, *other.agree(member.share())));
  CHECK_FALSE(opens(key_number(8), with, agreed, as_itself));
  auto elsewhere = with;
  elsewhere.joiner = mote_id{3};
  CHECK_FALSE(opens(credential, elsewhere, agreed, as_itself));
  auto on_other_terms = with;
  on_other_terms.terms = terms_of({.name = "kitchen"});
  CHECK_FALSE(opens(credential, on_other_terms, agreed, as_itself));
  CHECK(join_tag(credential, with) != join_tag(credential, on_other_terms));
  for (auto change : {&wrapped_keys::send_in_ms}) {
    auto changed = wrapped;
    ++(changed.*change);
    CHECK_FALSE(unwrap(made, changed, carrier));
  }
  const auto refreshed = wrap(refresh_key(credential, first_session.keys), second_session, 0s);
  CHECK(unwrap(refresh_key(credential, first_session.keys), refreshed));
  CHECK_FALSE(unwrap(refresh_key(credential, second_session.keys), refreshed));
  CHECK_FALSE(unwrap(refresh_key(key_number(8), first_session.keys), refreshed));
}

TEST_CASE("a key shows no more than a short fingerprint", "[smepp][SMP-13]") {
  static_assert(!printable_type<key> && !has_text<key>);
  static_assert(!printable_type<key_pair> && !has_text<key_pair>);
  static_assert(!described<key> && !described<key_pair> && !described<session_keys>);
  const auto secret = key_of("00112233445566778899aabbccddeeff");
  CHECK(secret.fingerprint().size() == 4);
  CHECK(secret.fingerprint() != key_number(1).fingerprint());
  CHECK_FALSE(key::from_hex("0011"));
  CHECK_FALSE(key::from_hex("00112233445566778899aabbccddeefg"));
}

TEST_CASE("keys for different purposes have nothing in common", "[smepp][SMP-13]") {
  const auto from = key_number(9);
  CHECK(derive(from, "a") == derive(from, "a"));
  CHECK_FALSE(derive(from, "a") == derive(from, "b"));
  CHECK_FALSE(derive(from, "a") == derive(from, "a", bytes{0}));
  CHECK_FALSE(derive(from, "a") == derive(key_number(8), "a"));
}

TEST_CASE("names of two groups are hidden with different key streams", "[smepp][SMP-05]") {
  const auto master = key_number(9);
  answer x;
  x.nonce = 4711;
  x.name = to_bytes(std::string_view("kitchen"));
  x.group = group;
  const auto hidden = hidden_name(master, alice, bob, x);
  auto again = x;
  again.name = hidden;
  CHECK(hidden_name(master, alice, bob, again) == x.name);
  again = x;
  again.group = group_id{78};
  CHECK_FALSE(hidden_name(master, alice, bob, again) == hidden);
}

TEST_CASE("a member reads what another has sealed, and no other does", "[smepp][SMP-03]") {
  auto a = peer(alice);
  auto b = peer(bob);
  b.believe(alice, group, first_session.id, 0);
  static_cast<void>(a.unique()); // the window begins above 0
  const auto frame = seal(a, "hello");
  CHECK(frame.size() == 5 + secured_overhead);
  CHECK(frame[0] == 1);
  CHECK((frame[2] << 8 | frame[3]) == group.value); // in clear, SMP-14
  CHECK(to_string(byte_view(frame)).find("hello") == std::string::npos);
  CHECK(open(b, alice, frame) == "hello");

  security outsider({mote_id{3}}, 0);
  CHECK(open(outsider, alice, frame) == "unknown_group");
  outsider.set_network_keys({key_number(7), key_number(8)}, instant{});
  outsider.set_group(group, {first_session});
  CHECK(open(outsider, alice, frame) != "unproven hello");
  auto stranger = peer(mote_id{4}); // has the network's keys, not the group's
  stranger.set_group(group, {{first_session.id, {key_number(7), key_number(8)}}});
  CHECK(open(stranger, alice, frame) == "tampered");
}

TEST_CASE("a frame that was changed anywhere is refused", "[smepp][SMP-03]") {
  auto a = peer(alice);
  auto b = peer(bob);
  const auto frame = seal(a, "value", bob);
  std::map<std::string, int> seen;
  for (std::size_t bit = 0; bit < 8 * frame.size(); ++bit) {
    auto changed = frame;
    changed[bit / 8] ^= static_cast<std::uint8_t>(1 << bit % 8);
    ++seen[open(b, alice, changed, bob)];
  }
  const auto all = static_cast<int>(8 * frame.size());
  CHECK(seen ==
        std::map<std::string, int>{
            {"unknown_suite", 8}, {"wrong_key", 8}, {"unknown_group", 16}, {"tampered", all - 32}});
  CHECK(open(b, mote_id{3}, frame, bob) == "tampered"); // another sender
  CHECK(open(b, alice, frame) == "tampered");           // another receiver
  for (std::size_t size = 0; size < frame.size(); ++size)
    CHECK(open(b, alice, byte_view(frame).first(size), bob) ==
          (size < secured_overhead ? "malformed" : "tampered"));
  CHECK(open(b, alice, bytes(200, 1), bob) == "malformed");
  CHECK(open(b, alice, frame, bob) == "unproven value");
}

TEST_CASE("a frame costs a bounded number of MACs to refuse", "[smepp][SMP-03]") {
  auto b = peer(bob);
  // Four pairs, three of which have the same number.
  b.set_group(group, {{{1, mote_id{1}}, {key_number(11), key_number(12)}},
                      {{1, mote_id{2}}, {key_number(13), key_number(14)}},
                      {{17, mote_id{3}}, {key_number(15), key_number(16)}},
                      {{2, mote_id{3}}, {key_number(17), key_number(18)}}});
  b.set_network_keys(network_keys, instant{}); // and all of them with keys before, too
  auto a = peer(alice);
  random_stream rng(1);
  for (int i = 0; i < 200; ++i) {
    auto frame = seal(a, "forged");
    for (std::size_t at = secured_header_size; at < frame.size(); ++at)
      frame[at] = static_cast<std::uint8_t>(rng.next());
    const auto before = b.counters().macs;
    static_cast<void>(open(b, alice, frame));
    CHECK(b.counters().macs - before <= security::macs_max);
    const auto after = b.counters().macs;
    frame[1] ^= 0x08;
    CHECK(open(b, alice, frame) == "wrong_key");
    CHECK(b.counters().macs == after);
  }
}

TEST_CASE("a frame is taken once, late ones too", "[smepp][SMP-03]") {
  auto a = peer(alice);
  auto b = peer(bob);
  b.believe(alice, group, first_session.id, 0);
  static_cast<void>(a.unique());
  std::vector<bytes> frames;
  for (int i = 0; i < 40; ++i)
    frames.push_back(seal(a, std::to_string(i)));
  CHECK(open(b, alice, frames[5]) == "5");
  CHECK(open(b, alice, frames[3]) == "3");
  CHECK(open(b, alice, frames[3]) == "replayed");
  CHECK(open(b, alice, frames[5]) == "replayed");
  CHECK(open(b, alice, frames[39]) == "39");
  CHECK(open(b, alice, frames[8]) == "8");        // 31 behind
  CHECK(open(b, alice, frames[7]) == "replayed"); // too old to know
  CHECK(b.counters().refused.at("replayed") == 3);
}

TEST_CASE("a sender whose counter is not known has to answer first", "[smepp][SMP-03]") {
  auto a = peer(alice);
  auto b = peer(bob);
  const auto recorded = seal(a, "old");
  CHECK(open(b, alice, recorded) == "unproven old");
  const auto nonce = b.challenge(alice, group, instant{});
  REQUIRE(nonce);
  CHECK_FALSE(b.challenge(alice, group, instant{} + 1s)); // not again so soon
  const auto at = [](std::uint64_t counter) {
    return opened_frame{group, first_session.id, counter, {}, false};
  };
  CHECK_FALSE(b.on_proof(alice, at(5), *nonce + 1));
  CHECK_FALSE(b.on_proof(bob, at(5), *nonce));
  CHECK(b.on_proof(alice, at(5), *nonce));
  CHECK_FALSE(b.on_proof(alice, at(7), *nonce)); // once
  CHECK(open(b, alice, recorded) == "replayed");
  while (*a.unique() < 5) {
  }
  CHECK(open(b, alice, seal(a, "new")) == "new");

  SECTION("after a loss of memory the recording is as worthless as before") {
    auto again = peer(bob, *b.take_store());
    CHECK(open(again, alice, recorded) == "unproven old");
    const auto next = again.challenge(alice, group, instant{});
    REQUIRE(next);
    CHECK(*next > *nonce); // an answer recorded before does not fit
  }
}

TEST_CASE("no counter is used twice, whenever the power fails", "[smepp][SMP-03]") {
  random_stream rng(5);
  std::set<std::uint64_t> used;
  std::uint64_t store = 0;
  for (int life = 0; life < 50; ++life) {
    auto a = peer(alice, store);
    for (auto left = rng.below(600); left > 0; --left) {
      const auto frame = seal(a, "x");
      if (const auto x = a.take_store())
        store = *x; // before the frame leaves
      byte_reader reader(frame);
      reader.skip(4);
      CHECK(used.insert(reader.big<std::uint64_t>()).second);
    }
  }
}

TEST_CASE("who has used up all counters is silent", "[smepp][SMP-03]") {
  security_config config{.self = alice, .counter_end = 1000};
  security a(config, 999);
  a.set_network_keys(network_keys, instant{});
  a.set_group(group, {first_session});
  CHECK(a.seal(bob, group, first_session.id, {}));
  CHECK(a.take_store() == 1000); // and not the first of somebody else's
  const auto none = a.seal(bob, group, first_session.id, {});
  REQUIRE_FALSE(none);
  CHECK(none.error() == errc::bad_value);
  CHECK(a.counters().used_up == 1);
  CHECK_FALSE(a.challenge(bob, group, instant{}));
  CHECK_FALSE(a.unique());
}

TEST_CASE("windows that do not fit are given up and asked for again", "[smepp][SMP-03]") {
  replay_windows x(2);
  using enum replay_windows::verdict;
  x.begin(mote_id{1}, group, 1, 1, 10);
  x.begin(mote_id{2}, group, 1, 1, 10);
  CHECK(x.judge(mote_id{1}, group, 1, 11) == fresh);
  x.accept(mote_id{1}, group, 1, 11);
  x.begin(mote_id{3}, group, 1, 1, 10);
  CHECK(x.size() == 2);
  CHECK(x.evicted() == 1);
  CHECK(x.judge(mote_id{2}, group, 1, 11) == unknown);
  CHECK(x.judge(mote_id{1}, group, 1, 11) == replayed);
  CHECK(x.judge(mote_id{1}, group_id{78}, 1, 12) == unknown); // a group of its own
}

TEST_CASE("no frame moves a window far, and each pair of keys has its own", "[smepp][SMP-03]") {
  replay_windows x;
  using enum replay_windows::verdict;
  const mote_id a{1};
  x.begin(a, group, 1, 1, 10);
  CHECK(x.judge(a, group, 1, 0xffffff00) == unknown);
  CHECK(x.judge(a, group, 1, 10 + replay_windows::jump_max) == fresh);
  x.begin(a, group, 1, 1, 0xffffff00); // it has said so, or somebody in its name
  CHECK(x.judge(a, group, 1, 11) == unknown);
  CHECK(x.judge(a, group, 2, 11) == fresh); // whatever happened under the keys before
  x.accept(a, group, 2, 11);
  CHECK(x.judge(a, group, 2, 11) == replayed);
  CHECK(x.judge(a, group, 2, 10) == fresh);
  x.begin(a, group, 1, 2, 12); // it has shown it: lower than before
  CHECK(x.judge(a, group, 1, 13) == fresh);
  CHECK(x.judge(a, group, 1, 12) == replayed);
  x.forget(group, 1);
  CHECK(x.judge(a, group, 1, 13) == unknown); // known when the other window began
  CHECK(x.judge(a, group, 3, 5) == fresh);

  SECTION("keys whose window has gone are not taken up again without a proof") {
    replay_windows small(2);
    small.begin(a, group, 1, 1, 10);
    small.accept(a, group, 2, 20);
    small.begin(mote_id{2}, group, 2, 2, 5); // both windows go
    CHECK(small.judge(a, group, 2, 20) == unknown);
    CHECK(small.judge(a, group, 1, 20) == unknown);
    small.begin(a, group, 1, 2, 30);
    CHECK(small.judge(a, group, 2, 20) == unknown);
  }
}

TEST_CASE("at network level a question is taken once a minute", "[smepp][SMP-03]") {
  auto b = peer(bob);
  const auto taken = [&](std::uint64_t counter, duration at) {
    return b.is_new_request(alice, {network_level, {}, counter, {}, false}, instant{} + at);
  };
  CHECK(taken(1, 0s));
  CHECK_FALSE(taken(1, 1s));
  CHECK(taken(2, 2s));
  CHECK_FALSE(taken(1, 3s));
  CHECK_FALSE(taken(2, 61s));
  CHECK(b.counters().refused.at("replayed") == 3);
  CHECK(taken(1, 63s));
}

TEST_CASE("who asks in many names takes nothing from those that were there", "[smepp][SMP-03]") {
  source_table x(4, 2);
  const auto at = instant{} + 1h;
  x.note(mote_id{1}, 5, at);
  int granted = 0;
  for (std::uint16_t i = 2; i < 1000; ++i)
    granted += x.take(mote_id{i}, at) ? 1 : 0;
  CHECK(granted <= 3 + 2);
  CHECK(x.take(mote_id{1}, at));
  CHECK(x.is_old(mote_id{1}, 5, at + 10s));
  CHECK_FALSE(x.is_old(mote_id{1}, 6, at + 10s));
}

TEST_CASE("network keys change without a gap, and cut off who keeps the old", "[smepp][SMP-02]") {
  auto a = peer(alice);
  auto b = peer(bob);
  auto behind = peer(mote_id{3});
  for (auto* each : {&b, &behind})
    each->believe(alice, group, first_session.id, 0);
  b.believe(mote_id{3}, group, first_session.id, 0);
  static_cast<void>(a.unique());
  static_cast<void>(behind.unique());
  const key_pair next{key_number(21), key_number(22)};
  b.set_network_keys(next, instant{} + 100s);
  CHECK(open(b, alice, seal(a, "late"), broadcast_mote, instant{} + 110s) == "late");
  a.set_network_keys(next, instant{} + 110s);
  const auto fresh = seal(a, "new");
  CHECK(open(b, alice, fresh, broadcast_mote, instant{} + 111s) == "new");
  CHECK(open(behind, alice, fresh, broadcast_mote, instant{} + 111s) == "wrong_key");
  const auto old = seal(behind, "old");
  CHECK(open(b, mote_id{3}, old, broadcast_mote, instant{} + 160s) == "wrong_key");
  CHECK(b.deadline() == std::nullopt);
}

TEST_CASE("old session keys are accepted for one grace period", "[smepp][SMP-13]") {
  session_ring ring(60s);
  const instant start{};
  CHECK(ring.learn(first_session, start, start));
  CHECK(ring.sending(start) == first_session.id);
  CHECK_FALSE(ring.deadline());
  CHECK(ring.learn(second_session, start + 10s, start));
  CHECK_FALSE(ring.learn(second_session, start + 20s, start));
  CHECK(ring.sending(start + 9s) == first_session.id); // others may not have the new pair yet
  CHECK(ring.sending(start + 10s) == second_session.id);
  CHECK(ring.accepted().size() == 2);
  CHECK(ring.deadline() == start + 70s);
  CHECK_FALSE(ring.on_time(start + 69s));
  CHECK(ring.on_time(start + 70s));
  CHECK(ring.accepted().size() == 1);
  CHECK(ring.find(first_session.id) == nullptr);
}

TEST_CASE("members who change keys at once agree on one pair", "[smepp][SMP-13]") {
  const session_keys by_one{{2, mote_id{1}}, {}};
  const session_keys by_two{{2, mote_id{2}}, {}};
  CHECK(is_better(by_one.id, by_two.id));
  CHECK(is_better({0, mote_id{9}}, {0xffff, mote_id{1}})); // wraps
  for (const bool one_first : {true, false}) {
    session_ring ring(60s);
    ring.learn(first_session, instant{}, instant{});
    CHECK(ring.learn(one_first ? by_one : by_two, instant{} + 5s, instant{}));
    CHECK(ring.learn(one_first ? by_two : by_one, instant{} + 6s, instant{}) != one_first);
    CHECK(ring.best().id == by_one.id);
    CHECK(ring.accepted().size() == 3);
    CHECK(ring.sending(instant{} + 10s) == by_one.id);
  }
}

TEST_CASE("a rate limiter bounds a burst and what follows", "[smepp][SMP-03]") {
  rate_limiter x(3, 1s);
  int granted = 0;
  for (int ms = 0; ms < 10'000; ms += 10)
    granted += x.take(instant{} + 100s + std::chrono::milliseconds(ms)) ? 1 : 0;
  CHECK(granted == 3 + 9);
  CHECK(x.refused() == 1000 - 12);
}
