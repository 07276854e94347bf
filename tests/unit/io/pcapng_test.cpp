#include <array>
#include <memory>
#include <string>
#include <utility>
#include <variant>

#include <pcap/pcap.h>

#include "io/files/pcapng.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

using namespace rubicon;

namespace {

bytes hex(std::string_view text) {
  std::string digits;
  for (const char each : text)
    if (each != ' ')
      digits += each;
  return from_hex(digits).value();
}

io::pcapng_file open_pcapng(const std::string& path) {
  auto x = io::pcapng_file::open(path, "kitchen");
  if (const auto* reason = std::get_if<std::string>(&x))
    FAIL(*reason);
  return std::get<io::pcapng_file>(std::move(x));
}

} // namespace

TEST_CASE("blocks of a pcapng file are as the format says, octet by octet", "[io]") {
  CHECK(io::pcapng::section_header("rubicon") ==
        hex("0a0d0d0a 2c000000 4d3c2b1a 0100 0000 ffffffffffffffff"
            "0400 0700 7275626963 6f6e00 0000 0000 2c000000"));
  CHECK(io::pcapng::interface_description(195, 127, "ab") ==
        hex("01000000 28000000 c300 0000 7f000000 0200 0200 61620000"
            "0900 0100 09000000 0000 0000 28000000"));
  CHECK(io::pcapng::interface_description(195, 127, "") ==
        hex("01000000 20000000 c300 0000 7f000000 0900 0100 09000000 0000 0000 20000000"));
}

TEST_CASE("a frame is padded, and has a comment if there is something to say", "[io]") {
  const instant at(std::chrono::nanoseconds(0x1'0203'0405));
  CHECK(io::pcapng::enhanced_packet(at, bytes{1, 2, 3, 4, 5}, "") ==
        hex("06000000 28000000 00000000 01000000 05040302 05000000 05000000 0102030405 000000"
            "28000000"));
  CHECK(io::pcapng::enhanced_packet(at, bytes{1, 2, 3, 4}, "lost") ==
        hex("06000000 30000000 00000000 01000000 05040302 04000000 04000000 01020304"
            "0100 0400 6c6f7374 0000 0000 30000000"));
  CHECK(io::pcapng::enhanced_packet(instant{}, {}, "").size() == 32);
}

TEST_CASE("a long comment is cut between characters", "[io]") {
  std::string comment(io::pcapng::comment_octets_max - 1, 'x');
  comment += "é and more";
  const auto block = io::pcapng::enhanced_packet(instant{}, {}, comment);
  CHECK(block[28] == 1); // a comment
  CHECK((block[30] | block[31] << 8) == static_cast<int>(io::pcapng::comment_octets_max - 1));
  CHECK(block.size() % 4 == 0);
}

TEST_CASE("libpcap reads a file of commented frames", "[io]") {
  const test::scratch_folder folder;
  const auto path = folder.file("air.pcapng");
  {
    auto file = open_pcapng(path);
    file.write(instant(1'500'000'001ns), bytes{2, 0, 7, 0xaa, 0xbb}, "");
    auto moved = std::move(file);
    moved.write(instant(24h), bytes(127, 'x'), "lost: collision, from fan (4) to sink (1)");
    moved.flush();
    CHECK(moved.error().empty());
  }
  std::array<char, PCAP_ERRBUF_SIZE> error{};
  const std::unique_ptr<pcap_t, decltype(&pcap_close)> file(
      pcap_open_offline_with_tstamp_precision(path.c_str(), PCAP_TSTAMP_PRECISION_NANO,
                                              error.data()),
      &pcap_close);
  INFO(error.data());
  REQUIRE(file);
  CHECK(pcap_datalink(file.get()) == 195);
  pcap_pkthdr* header = nullptr;
  const u_char* octets = nullptr;
  REQUIRE(pcap_next_ex(file.get(), &header, &octets) == 1);
  CHECK(header->ts.tv_sec == 1);
  CHECK(header->ts.tv_usec == 500'000'001);
  CHECK(bytes(octets, octets + header->caplen) == bytes{2, 0, 7, 0xaa, 0xbb});
  REQUIRE(pcap_next_ex(file.get(), &header, &octets) == 1);
  CHECK(header->ts.tv_sec == 86'400);
  CHECK(header->caplen == 127);
  CHECK(pcap_next_ex(file.get(), &header, &octets) == PCAP_ERROR_BREAK);
}

TEST_CASE("what cannot be written into a pcapng file is told", "[io]") {
  const test::scratch_folder folder;
  const auto none = io::pcapng_file::open(folder.file("a/b.pcapng"), "x");
  REQUIRE(std::holds_alternative<std::string>(none));
  CHECK(std::get<std::string>(none).ends_with("a/b.pcapng: No such file or directory"));
  auto full = open_pcapng("/dev/full");
  full.write(instant{}, bytes(5), "");
  full.flush();
  CHECK(full.error() == "/dev/full: No space left on device");
  full.write(instant{}, bytes(5), ""); // and stays so
  full.flush();
  CHECK(full.error() == "/dev/full: No space left on device");
}
