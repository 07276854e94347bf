// Captures of an island's air, read back octet by octet (ACT-07).
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <unistd.h>

#include "ecology_files.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::test;

namespace {

namespace fs = std::filesystem;

int made = 0; ///< scratch folders, each with a name of its own

/// A folder that is not there yet, and gone at the end.
class scratch_folder {
public:
  scratch_folder()
      : path_(fs::temp_directory_path() /
              ("rubicon-captures-" + std::to_string(getpid()) + "-" + std::to_string(++made))) {
    fs::remove_all(path_);
  }
  ~scratch_folder() { fs::remove_all(path_); }
  scratch_folder(const scratch_folder&) = delete;
  scratch_folder& operator=(const scratch_folder&) = delete;

  [[nodiscard]] std::string path() const { return path_.string(); }

private:
  fs::path path_;
};

struct record {
  std::uint64_t at_ns = 0;
  std::string psdu;
  std::string comment; ///< pcapng only
};

struct capture {
  std::uint32_t magic = 0;
  std::uint32_t version = 0; ///< minor in the upper half
  std::uint32_t link_type = 0;
  std::vector<record> records;
  bool complete = false; ///< it ends with a record's end
};

/// In the byte order of this machine, as libpcap writes it.
std::optional<std::uint32_t> number(const std::string& from, std::size_t& at) {
  if (from.size() - at < 4)
    return std::nullopt;
  std::uint32_t x = 0;
  from.copy(reinterpret_cast<char*>(&x), 4, at);
  at += 4;
  return x;
}

capture read_capture(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string all((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  capture x;
  std::size_t at = 0;
  if (all.size() < 24)
    return x;
  x.magic = *number(all, at);
  x.version = *number(all, at);
  at = 20;
  x.link_type = *number(all, at);
  while (at < all.size()) {
    const auto seconds = number(all, at);
    const auto nanoseconds = number(all, at);
    const auto captured = number(all, at);
    const auto length = number(all, at);
    if (!length || captured != length || all.size() - at < *length)
      return x;
    x.records.push_back(
        {*seconds * std::uint64_t{1'000'000'000} + *nanoseconds, all.substr(at, *length), {}});
    at += *length;
  }
  x.complete = true;
  return x;
}

/// FCS of IEEE 802.15.4-2006 7.2.1.9: ITU-T CRC-16 with the least significant bit first.
std::uint16_t fcs(std::string_view octets) {
  std::uint16_t sum = 0;
  for (const char c : octets) {
    sum ^= static_cast<std::uint8_t>(c);
    for (int bit = 0; bit < 8; ++bit)
      sum = static_cast<std::uint16_t>((sum >> 1U) ^ ((sum & 1U) != 0 ? 0x8408U : 0U));
  }
  return sum;
}

/// The same of a pcapng file: a section, an interface, and frames with a comment or none.
capture read_commented(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string all((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  capture x;
  std::size_t at = 0;
  while (at < all.size()) {
    const auto begin = at;
    const auto type = number(all, at);
    const auto length = number(all, at);
    if (!type || !length || *length < 12 || all.size() - begin < *length)
      return x;
    if (*type == 0x0a0d0d0a)
      x.magic = *number(all, at);
    if (*type == 1)
      x.link_type = *number(all, at);
    if (*type == 6) {
      record y;
      at += 4; // the interface
      y.at_ns = std::uint64_t{*number(all, at)} << 32U;
      y.at_ns |= *number(all, at);
      const auto size = *number(all, at);
      at += 4; // on the air
      y.psdu = all.substr(at, size);
      at += (size + 3) / 4 * 4;
      if (at < begin + *length - 4) {
        const auto option = *number(all, at);
        CHECK((option & 0xffffU) == 1); // a comment
        y.comment = all.substr(at, option >> 16U);
      }
      x.records.push_back(std::move(y));
    }
    at = begin + *length;
  }
  x.complete = true;
  return x;
}

void check_frames(const capture& x, duration length);

void check_capture(const capture& x, duration length) {
  CHECK(x.magic == 0xa1b23c4d); // times to the nanosecond
  CHECK(x.version == (4U << 16U | 2U));
  check_frames(x, length);
}

void check_commented(const capture& x, duration length) {
  CHECK(x.magic == 0x1a2b3c4d);
  check_frames(x, length);
}

void check_frames(const capture& x, duration length) {
  CHECK(x.link_type == 195); // IEEE 802.15.4 with FCS
  CHECK(x.complete);
  std::uint64_t last = 0;
  bool ascending = true;
  bool sane = true;
  bool intact = true;
  for (const auto& record : x.records) {
    ascending = ascending && record.at_ns >= last;
    last = record.at_ns;
    sane = sane && record.psdu.size() >= 5 && record.psdu.size() <= 127;
    const auto sum =
        static_cast<std::uint16_t>(static_cast<std::uint8_t>(record.psdu[record.psdu.size() - 2]) |
                                   static_cast<std::uint8_t>(record.psdu.back()) << 8U);
    intact = intact && sum == fcs(record.psdu.substr(0, record.psdu.size() - 2));
  }
  CHECK(ascending);
  CHECK(sane);
  CHECK(intact);
  CHECK(last <= static_cast<std::uint64_t>(length.count()));
}

report::run_report captured(const config::ecology_description& what, const std::string& folder,
                            bool lost) {
  run_options options;
  options.seed = 1;
  options.pcap_folder = folder;
  options.pcap_lost = lost;
  return run_ecology(what, options);
}

} // namespace

TEST_CASE("each island's air is captured, and the run is the same", "[ecology][ACT-07][GEN-07]") {
  auto home = example("home.toml");
  home.length = 1min;
  const auto plain = run(home);
  const scratch_folder folder;
  const auto report = captured(home, folder.path() + "/in/it", false);
  CHECK(report.trace_hash == plain.trace_hash);
  CHECK(report.violations.empty());
  std::size_t files = 0;
  for (const auto& entry : fs::directory_iterator(folder.path() + "/in/it")) {
    (void)entry;
    ++files;
  }
  CHECK(files == report.islands.size());
  for (const auto& island : report.islands) {
    INFO(island.name);
    const auto x = read_capture(folder.path() + "/in/it/island-" + to_string(island.id) + ".pcap");
    check_capture(x, home.length);
    CHECK(x.records.size() > 50);
    CHECK(x.records.size() <= island.radio.transmissions);
  }
}

TEST_CASE("what nobody received is captured if it is asked for", "[ecology][ACT-07]") {
  // Every other frame or so is lost on its only way.
  const auto what = describe(R"(
    ecology = { name = "lossy", duration = "20s" }
    radio.loss = "40%"
    [[island]]
    id = 7
    name = "far"
    stack = "mac"
    sink.apps = [{ app = "receiver" }]
    mote = [{ id = 2, position_m = [3, 0], apps = [
      { app = "sender", to = "sink", payload = 33, every = "100ms", ack = false }] }]
  )");
  const auto plain = run(what);
  const scratch_folder received;
  const scratch_folder all;
  const auto report = captured(what, received.path(), false);
  CHECK(report.trace_hash == plain.trace_hash);
  CHECK(captured(what, all.path(), true).trace_hash == plain.trace_hash);

  const auto some = read_capture(received.path() + "/island-7.pcap");
  const auto every = read_commented(all.path() + "/island-7.pcapng");
  check_capture(some, what.length);
  check_commented(every, what.length);
  const auto& radio = report.islands.at(0).radio;
  CHECK(some.records.size() == radio.delivered); // one receiver, so one copy each
  CHECK(every.records.size() == radio.transmissions);
  CHECK(every.records.size() > some.records.size());
  std::size_t lost = 0;
  for (const auto& record : every.records) {
    CHECK(record.psdu.size() == 33 + 9 + 2);
    lost += record.comment.empty() ? 0 : 1;
    if (!record.comment.empty())
      CHECK(record.comment.starts_with("lost: ")); // why is known of what a layer above sent to one
  }
  CHECK(lost == every.records.size() - some.records.size());

  // A folder that is there is used again, and its captures are made anew.
  (void)captured(what, all.path(), false);
  CHECK(read_capture(all.path() + "/island-7.pcap").records.size() == some.records.size());
}

TEST_CASE("acknowledgements are in the capture", "[ecology][ACT-07]") {
  const auto what = describe(R"(
    ecology = { name = "acked", duration = "10s" }
    [[island]]
    id = 1
    name = "near"
    stack = "mac"
    sink.apps = [{ app = "receiver" }]
    mote = [{ id = 2, position_m = [3, 0], apps = [
      { app = "sender", to = "sink", payload = 20, every = "100ms", start = "50ms" }] }]
  )");
  const scratch_folder folder;
  const auto report = captured(what, folder.path(), true);
  const auto x = read_commented(folder.path() + "/island-1.pcapng");
  check_commented(x, what.length);
  REQUIRE(x.records.size() == report.islands.at(0).radio.transmissions);
  REQUIRE(x.records.size() == 200);
  for (std::size_t i = 0; i < x.records.size(); i += 2) {
    const auto& data = x.records[i];
    const auto& ack = x.records[i + 1];
    REQUIRE(data.psdu.size() == 31);
    REQUIRE(ack.psdu.size() == 5);
    CHECK((static_cast<unsigned>(ack.psdu[0]) & 7U) == 2); // its type
    CHECK(ack.psdu[2] == data.psdu[2]);                    // DSN
    // The frame, 6 octets before it, and a turnaround of 12 symbols.
    CHECK(ack.at_ns - data.at_ns == ((31 + 6) * 32 + 192) * 1000);
  }
}

TEST_CASE("a capture that cannot be written is an error", "[ecology][ACT-07]") {
  auto home = example("home.toml");
  home.length = 1s;
  const scratch_folder folder;
  fs::create_directories(folder.path());
  std::ofstream(folder.path() + "/file") << "in the way";
  CHECK_THROWS_AS(captured(home, folder.path() + "/file", false), std::runtime_error);
  CHECK_THROWS_AS(captured(home, folder.path() + "/file/below", false), std::runtime_error);
  fs::create_directories(folder.path() + "/taken/island-1.pcap");
  CHECK_THROWS_AS(captured(home, folder.path() + "/taken", false), std::runtime_error);
}
