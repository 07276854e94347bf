// Compressed files, valid and hostile.
#include <string>

#define ZLIB_CONST
#include <zlib.h>

#include "imports/gzip.hpp"
#include "unit/imports/shapes.hpp"

namespace {

using namespace shapes;

/// `A B 0.5` and a newline, as gzip 1.12 has written it.
constexpr unsigned char from_gzip[] = {0x1f, 0x8b, 0x08, 0x00, 0x00, 0x00, 0x00, 0x00, 0x02, 0x03,
                                       0x73, 0x54, 0x70, 0x52, 0x30, 0xd0, 0x33, 0xe5, 0x02, 0x00,
                                       0x06, 0x18, 0xe5, 0x4c, 0x08, 0x00, 0x00, 0x00};

std::string compressed(std::string_view text) {
  z_stream stream{};
  REQUIRE(::deflateInit2(&stream, 1, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY) == Z_OK);
  std::string out(::deflateBound(&stream, static_cast<uLong>(text.size())), '\0');
  stream.next_in = reinterpret_cast<const Bytef*>(text.data());
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  REQUIRE(::deflate(&stream, Z_FINISH) == Z_STREAM_END);
  out.resize(stream.total_out);
  ::deflateEnd(&stream);
  return out;
}

std::string content(std::string_view octets) {
  auto x = gunzip(octets);
  REQUIRE(std::holds_alternative<std::string>(x));
  return std::get<std::string>(std::move(x));
}

std::string why_not(std::string_view octets) {
  const auto x = gunzip(octets);
  REQUIRE(std::holds_alternative<import_problem>(x));
  return std::get<import_problem>(x).message;
}

} // namespace

TEST_CASE("what gzip has written is decompressed", "[imports]") {
  const std::string_view octets(reinterpret_cast<const char*>(from_gzip), sizeof from_gzip);
  CHECK(is_gzip(octets));
  CHECK(content(octets) == "A B 0.5\n");
  CHECK_FALSE(is_gzip("A B 0.5\n"));
  CHECK_FALSE(is_gzip(""));
}

TEST_CASE("members of a compressed file follow each other, padded or not", "[imports]") {
  const auto text = repeated("line #\n", 50'000);
  CHECK(content(compressed(text)) == text);
  CHECK(content(compressed("a") + compressed("") + compressed("b")) == "ab");
  CHECK(content(compressed("a") + std::string(512, '\0')) == "a");
  CHECK(why_not(compressed("a") + "b") == "there is something else behind its compressed content");
}

TEST_CASE("a compressed file that is cut off anywhere is refused", "[imports]") {
  const auto whole = compressed("A B 0.5\nB C 1\n");
  for (std::size_t i = 2; i < whole.size(); ++i)
    CHECK(why_not(std::string_view(whole).substr(0, i)) == "its compressed content ends too early");
}

TEST_CASE("a compressed file with a changed octet is refused, or has the same content",
          "[imports]") {
  const std::string text = "A B 0.5\nB C 1\n";
  const auto whole = compressed(text);
  for (std::size_t i = 2; i < whole.size(); ++i) {
    auto changed = whole;
    changed[i] = static_cast<char>(changed[i] ^ 0x55);
    const auto x = gunzip(changed);
    CHECK((std::holds_alternative<import_problem>(x) || std::get<std::string>(x) == text));
  }
}

TEST_CASE("a compressed file has as much content as any other file", "[imports]") {
  std::string text(file_octets_max, ' ');
  CHECK(content(compressed(text)).size() == file_octets_max);
  text += ' ';
  CHECK(why_not(compressed(text)) == "it has more than 64 MiB when it is decompressed");
  // Once more compressed, this is a bomb of a few hundred octets: its content is no file.
  CHECK(is_gzip(content(compressed(compressed(text)))));
}
