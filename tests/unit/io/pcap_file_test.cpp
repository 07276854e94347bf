#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <pcap/pcap.h>
#include <sys/wait.h>
#include <unistd.h>

#include "io/files/pcap_file.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"
#include "support/vectors.hpp"

using namespace rubicon;

namespace {

struct captured {
  std::int64_t ns = 0;
  bytes psdu;

  friend bool operator==(const captured&, const captured&) = default;
};

struct capture {
  int link_type = 0;
  std::vector<captured> frames;
};

capture read_back(const std::string& path) {
  std::array<char, PCAP_ERRBUF_SIZE> error{};
  const std::unique_ptr<pcap_t, decltype(&pcap_close)> file(
      pcap_open_offline_with_tstamp_precision(path.c_str(), PCAP_TSTAMP_PRECISION_NANO,
                                              error.data()),
      &pcap_close);
  INFO(error.data());
  REQUIRE(file);
  capture x;
  x.link_type = pcap_datalink(file.get());
  pcap_pkthdr* header = nullptr;
  const u_char* octets = nullptr;
  int status = 0;
  while ((status = pcap_next_ex(file.get(), &header, &octets)) == 1) {
    CHECK(header->caplen == header->len);
    x.frames.push_back({header->ts.tv_sec * 1'000'000'000 + header->ts.tv_usec,
                        bytes(octets, octets + header->caplen)});
  }
  CHECK(status == PCAP_ERROR_BREAK); // the end, and no half a frame
  return x;
}

/// The golden PSDU of a name in tinyos/radio-frames.txt.
bytes golden(const std::string& name) {
  for (const auto& x : test::read_cases("tinyos/radio-frames.txt")) {
    if (x.at("name") == name)
      return from_hex(x.at("psdu")).value();
  }
  throw std::runtime_error(name);
}

io::pcap_file open_pcap(const std::string& path) {
  auto x = io::pcap_file::open(path);
  if (const auto* reason = std::get_if<std::string>(&x))
    FAIL(*reason);
  return std::get<io::pcap_file>(std::move(x));
}

std::string output_of(const std::string& command) {
  const std::unique_ptr<FILE, decltype(&::pclose)> pipe(::popen(command.c_str(), "r"), &::pclose);
  if (!pipe)
    throw std::runtime_error("popen");
  std::string text;
  std::array<char, 4096> block{};
  while (const auto size = std::fread(block.data(), 1, block.size(), pipe.get()))
    text.append(block.data(), size);
  return text;
}

/// A unicast data frame, its ack, a broadcast and the longest there is.
std::vector<captured> sample() {
  return {{1'500'000'001, golden("rad-02")},
          {1'500'864'001, golden("rad-03")},
          {1'999'999'999, golden("rad-01")},
          {86'400'000'000'000, golden("rad-05")}};
}

void write_sample(const std::string& path) {
  auto file = open_pcap(path);
  for (const auto& x : sample())
    file.write(instant(duration(x.ns)), x.psdu);
  file.flush();
  CHECK(file.error().empty());
  CHECK(file.frames() == sample().size());
}

} // namespace

TEST_CASE("a capture holds each frame and its time to the nanosecond", "[io]") {
  const test::scratch_folder folder;
  const auto path = folder.file("air.pcap");
  write_sample(path);
  const auto back = read_back(path);
  CHECK(back.link_type == 195);
  CHECK(back.frames == sample());
}

TEST_CASE("a capture without frames is a capture", "[io]") {
  const test::scratch_folder folder;
  const auto path = folder.file("air.pcap");
  open_pcap(path).flush();
  CHECK(read_back(path).frames.empty());
}

TEST_CASE("a capture that is closed without a flush is whole", "[io]") {
  const test::scratch_folder folder;
  const auto path = folder.file("air.pcap");
  {
    auto file = open_pcap(path);
    file.write(instant{}, golden("rad-03"));
    auto moved = std::move(file);
    moved.write(instant(1ns), golden("rad-01"));
  }
  CHECK(read_back(path).frames ==
        std::vector<captured>{{0, golden("rad-03")}, {1, golden("rad-01")}});
}

TEST_CASE("a capture replaces the file of its name", "[io]") {
  const test::scratch_folder folder;
  const auto path = folder.file("air.pcap");
  write_sample(path);
  open_pcap(path).flush();
  CHECK(read_back(path).frames.empty());
}

TEST_CASE("a capture that cannot be opened says why", "[io]") {
  const test::scratch_folder folder;
  const auto path = folder.file("nowhere/air.pcap");
  const auto x = io::pcap_file::open(path);
  REQUIRE(std::holds_alternative<std::string>(x));
  CHECK(std::get<std::string>(x) == path + ": No such file or directory");
}

TEST_CASE("a full disk is told at the flush at the latest, and stays told", "[io]") {
  if (!std::filesystem::exists("/dev/full"))
    return;
  auto file = open_pcap("/dev/full");
  const auto psdu = golden("rad-05");
  file.write(instant{}, psdu);
  file.flush();
  CHECK(file.error() == "/dev/full: No space left on device");
  const auto frames = file.frames();
  file.write(instant{}, psdu);
  file.flush();
  CHECK(file.frames() == frames);
  CHECK(file.error() == "/dev/full: No space left on device");
}

TEST_CASE("a full disk is told without a flush once the buffer is full", "[io]") {
  if (!std::filesystem::exists("/dev/full"))
    return;
  auto file = open_pcap("/dev/full");
  const auto psdu = golden("rad-05");
  for (int i = 0; i < 10'000 && file.error().empty(); ++i)
    file.write(instant(duration(i)), psdu);
  CHECK(file.error() == "/dev/full: No space left on device");
  CHECK(file.frames() < 10'000);
}

TEST_CASE("tshark finds nothing wrong with a capture", "[io]") {
  if (std::system("command -v tshark >/dev/null 2>&1") != 0) {
    WARN("skipped: no tshark");
    return;
  }
  const test::scratch_folder folder;
  const auto path = folder.file("air.pcap");
  write_sample(path);
  const auto fields = "tshark -n -r '" + path +
                      "' -T fields -E separator=, -e frame.time_epoch -e wpan.frame_type "
                      "-e wpan.fcs_ok -e wpan.dst16 -e wpan.src16 -e _ws.malformed 2>/dev/null";
  CHECK(output_of(fields) == "1.500000001,0x0001,1,0x0001,0x0003,\n"
                             "1.500864001,0x0002,1,,,\n"
                             "1.999999999,0x0001,1,0xffff,0x0003,\n"
                             "86400.000000000,0x0001,1,0x0001,0xbeef,\n");
  auto broken = open_pcap(path);
  broken.write(instant{}, golden("rad-90"));
  broken.flush();
  CHECK(output_of(fields).starts_with("0.000000000,0x0001,0,"));
}
