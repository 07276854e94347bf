#include <algorithm>
#include <string>

#include "core/bytes.hpp"
#include "core/codec.hpp"
#include "core/hash.hpp"
#include "core/time.hpp"
#include "support/catch.hpp"

using namespace rubicon;

TEST_CASE("hexadecimal is read and written, and what is not hexadecimal is refused", "[core]") {
  CHECK(to_hex(bytes{0x00, 0xca, 0xfe}) == "00cafe");
  CHECK(from_hex("00 CA\nfe") == bytes{0x00, 0xca, 0xfe});
  CHECK(from_hex("") == bytes{});
  CHECK_FALSE(from_hex("0"));
  CHECK_FALSE(from_hex("0g"));
}

TEST_CASE("a writer and a reader agree on both byte orders", "[core]") {
  byte_writer out;
  out.big<std::uint32_t>(0x01020304).little<std::uint16_t>(0x0506).big<std::int16_t>(-2).octet(7);
  CHECK(to_hex(out.view()) == "010203040605fffe07");
  byte_reader in(out.view());
  CHECK(in.big<std::uint32_t>() == 0x01020304);
  CHECK(in.little<std::uint16_t>() == 0x0506);
  CHECK(in.big<std::int16_t>() == -2);
  CHECK(in.octet() == 7);
  CHECK(in.ok());
  CHECK(in.remaining() == 0);
}

TEST_CASE("a writer that expects a size takes memory once, and may write more", "[core]") {
  byte_writer writer(6);
  writer.big(std::uint16_t{0x0102});
  const auto* const memory = writer.view().data();
  writer.little(std::uint32_t{0x03040506});
  CHECK(writer.view().data() == memory);
  writer.octet(7);
  CHECK(to_hex(writer.finish()) == "01020605040307");
}

TEST_CASE("reading past the end yields zeros and stays failed", "[core]") {
  const bytes octets{1, 2, 3};
  byte_reader in(octets);
  CHECK(in.big<std::uint32_t>() == 0);
  CHECK_FALSE(in.ok());
  CHECK(in.octet() == 0);
  CHECK_FALSE(in.ok());
}

TEST_CASE("fixed text is cut to leave a NUL and needs one to be read", "[core]") {
  byte_writer out;
  out.fixed_text("kitchen", 4);
  CHECK(to_hex(out.view()) == "6b697400");
  byte_reader in(out.view());
  CHECK(in.fixed_text(4) == "kit");
  const bytes full{'a', 'b'};
  byte_reader bad(full);
  CHECK(bad.fixed_text(2).empty());
  CHECK_FALSE(bad.ok());
}

TEST_CASE("a payload is shared, compares by content and may be empty", "[core]") {
  const payload a(bytes{1, 2});
  const payload b = a;
  CHECK(a.view().data() == b.view().data());
  CHECK(a == payload(bytes{1, 2}));
  CHECK_FALSE(a == payload());
  CHECK(payload().view().empty());
}

TEST_CASE("a fold depends on content, length and order", "[core]") {
  CHECK(fold64().add(1).add(2).value() != fold64().add(2).add(1).value());
  CHECK(fold64().add("ab").add("c").value() != fold64().add("a").add("bc").value());
  CHECK(to_hex(fold64().add("rubicon").add(7).value()) ==
        to_hex(fold64().add("rubicon").add(7).value()));
  CHECK(to_hex(std::uint64_t{0xbeef}) == "000000000000beef");
}

TEST_CASE("a fold of text is that of its words, the first octet in the lowest bits", "[core]") {
  std::string text;
  for (unsigned size = 0; size <= 40; ++size) {
    fold64 by_words;
    by_words.add(std::uint64_t{size});
    for (std::size_t at = 0; at < size; at += 8) {
      std::uint64_t word = 0;
      for (std::size_t i = at; i < std::min<std::size_t>(at + 8, size); ++i)
        word |= std::uint64_t{static_cast<unsigned char>(text[i])} << (8 * (i - at));
      by_words.add(word);
    }
    CHECK(fold64().add(text).value() == by_words.value());
    text += static_cast<char>(200 + 3 * size); // beyond ASCII, where a char may be negative
  }
}

TEST_CASE("times are written as people read them", "[core]") {
  CHECK(to_text(instant{12s + 4160us}) == "12.004160");
  CHECK(to_text(duration{31s}) == "31 s");
  CHECK(to_text(duration{10min}) == "10 min");
  CHECK(to_text(duration{1500us}) == "1.5 ms");
  CHECK(to_text(duration{0}) == "0 ns");
}
