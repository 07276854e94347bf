// A reader of MCAP files that shares nothing with the writer: what https://mcap.dev/spec says of
// records, checked one by one.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

namespace rubicon::test {

struct mcap_message {
  std::uint16_t channel = 0;
  std::uint32_t sequence = 0;
  std::uint64_t time = 0;
  std::string data;
};

struct mcap_channel {
  std::uint16_t schema = 0;
  std::string topic;
  std::string encoding;

  friend bool operator==(const mcap_channel&, const mcap_channel&) = default;
};

/// Bit by bit, after ISO 3309.
inline std::uint32_t checksum(std::string_view octets) {
  std::uint32_t x = 0xffffffff;
  for (const auto c : octets) {
    x ^= static_cast<std::uint8_t>(c);
    for (int i = 0; i < 8; ++i)
      x = (x >> 1U) ^ (0xedb88320U & (0U - (x & 1U)));
  }
  return ~x;
}

class mcap_file {
public:
  using schema = std::tuple<std::string, std::string, std::string>; ///< name, encoding, text

  std::map<std::uint16_t, schema> schemas;
  std::map<std::uint16_t, mcap_channel> channels;
  std::vector<mcap_message> messages; ///< as they stand in the file
  std::size_t chunks = 0;
  std::vector<std::string> problems;

  explicit mcap_file(std::string_view octets) : all_(octets) {
    const std::string_view magic("\x89MCAP\x30\r\n", 8);
    const auto size = octets.size();
    if (size < 16 || octets.substr(0, 8) != magic || octets.substr(size - 8) != magic) {
      complain("no magic");
      return;
    }
    read_data();
    read_summary();
    check_messages();
  }

  [[nodiscard]] std::vector<mcap_message> of(const std::string& topic) const {
    std::vector<mcap_message> found;
    for (const auto& each : messages)
      if (const auto to = channels.find(each.channel);
          to != channels.end() && to->second.topic == topic)
        found.push_back(each);
    return found;
  }

private:
  /// What is left of a record; reads zeros behind its end.
  struct fields {
    std::string_view rest;
    bool ended = false;

    std::uint64_t number(std::size_t size) {
      std::uint64_t x = 0;
      for (std::size_t i = size; i-- > 0;)
        x = x << 8U | (i < rest.size() ? static_cast<std::uint8_t>(rest[i]) : 0U);
      ended = ended || size > rest.size();
      rest.remove_prefix(std::min(size, rest.size()));
      return x;
    }
    std::uint16_t u16() { return static_cast<std::uint16_t>(number(2)); }
    std::uint32_t u32() { return static_cast<std::uint32_t>(number(4)); }
    std::uint64_t u64() { return number(8); }
    std::string_view octets(std::uint64_t size) {
      ended = ended || size > rest.size();
      const auto x = rest.substr(0, size);
      rest.remove_prefix(x.size());
      return x;
    }
    std::string text() { return std::string(octets(u32())); }
  };

  struct record {
    int code = 0;
    std::uint64_t begin = 0;
    std::uint64_t end = 0;
    fields content;
  };

  struct chunk {
    std::uint64_t begin = 0;
    std::uint64_t size = 0;
    std::string_view records;
    std::map<std::uint16_t, std::uint64_t> indices; ///< where they begin
    std::size_t indexed = 0;                        ///< messages
    std::size_t held = 0;
    std::uint64_t first = 0;
    std::uint64_t last = 0;
  };

  void complain(const std::string& what) { problems.push_back(what); }
  void demand(bool holds, const std::string& what) {
    if (!holds)
      complain(what);
  }

  static record record_at(std::string_view in, std::uint64_t at) {
    fields x{in.substr(std::min<std::uint64_t>(at, in.size()))};
    record y;
    y.begin = at;
    y.code = static_cast<int>(x.number(1));
    const auto size = x.u64();
    y.content = {x.octets(size)};
    y.end = x.ended ? in.size() : at + 9 + size;
    return y;
  }

  void read_data() {
    for (at_ = 8; at_ + 8 < all_.size();) {
      auto x = record_at(all_, at_);
      demand((x.code == 0x01) == (at_ == 8), "the header is not the first record");
      at_ = x.end;
      if (x.code == 0x06)
        read_chunk(x);
      else if (x.code == 0x07)
        read_index(x.content, x.begin);
      else if (x.code == 0x0f) {
        demand(x.content.u32() == checksum(all_.substr(0, x.begin)), "checksum of the data");
        return;
      } else
        demand(x.code == 0x01, "a record outside chunks");
    }
    complain("the data has no end");
  }

  void read_chunk(record& x) {
    chunk y;
    y.begin = x.begin;
    y.size = x.end - x.begin;
    y.first = x.content.u64();
    y.last = x.content.u64();
    const auto size = x.content.u64();
    const auto crc = x.content.u32();
    demand(x.content.text().empty(), "a chunk is compressed");
    y.records = x.content.octets(x.content.u64());
    demand(size == y.records.size() && x.content.rest.empty() && !x.content.ended,
           "size of a chunk");
    demand(crc == checksum(y.records), "checksum of a chunk");
    for (std::uint64_t at = 0; at < y.records.size();) {
      auto each = record_at(y.records, at);
      at = each.end;
      if (each.code == 0x05)
        read_message(each.content, y);
      else
        read_declaration(each, schemas, channels);
    }
    chunks_.push_back(y);
    ++chunks;
  }

  void read_declaration(record& x, std::map<std::uint16_t, schema>& all_schemas,
                        std::map<std::uint16_t, mcap_channel>& all_channels) {
    const auto id = x.content.u16();
    if (x.code == 0x03) {
      auto name = x.content.text();
      auto encoding = x.content.text();
      demand(id != 0 && all_schemas.try_emplace(id, name, encoding, x.content.text()).second,
             "two schemas of one id");
    } else if (x.code == 0x04) {
      mcap_channel y;
      y.schema = x.content.u16();
      y.topic = x.content.text();
      y.encoding = x.content.text();
      demand(all_schemas.contains(y.schema), "a channel without schema");
      demand(all_channels.try_emplace(id, y).second, "two channels of one id");
      demand(x.content.text().empty(), "metadata of a channel");
    } else
      complain("a record that may not be there");
    demand(x.content.rest.empty() && !x.content.ended, "size of a schema or channel");
  }

  void read_message(fields& x, chunk& in) {
    mcap_message y;
    y.channel = x.u16();
    y.sequence = x.u32();
    y.time = x.u64();
    demand(x.u64() == y.time, "published at another time than logged");
    demand(channels.contains(y.channel), "a message without channel");
    demand(y.time >= in.first && y.time <= in.last, "a message outside the times of its chunk");
    y.data = x.rest;
    ++in.held;
    messages.push_back(std::move(y));
  }

  void read_index(fields& x, std::uint64_t begin) {
    if (chunks_.empty())
      return complain("an index without chunk");
    auto& of = chunks_.back();
    const auto channel = x.u16();
    demand(of.indices.try_emplace(channel, begin).second, "two indices of one channel");
    fields entries{x.octets(x.u32())};
    while (!entries.rest.empty() && !entries.ended) {
      const auto time = entries.u64();
      auto message = record_at(of.records, entries.u64());
      demand(message.code == 0x05 && message.content.u16() == channel, "index of another channel");
      message.content.u32();
      demand(message.content.u64() == time, "index of another time");
      ++of.indexed;
    }
    demand(!entries.ended && x.rest.empty(), "size of an index");
  }

  void read_summary() {
    if (all_.size() < 8 + 8 + 29)
      return complain("no room for a footer");
    const auto footer_at = all_.size() - 8 - 29;
    auto footer = record_at(all_, footer_at);
    demand(footer.code == 0x02 && footer.end == all_.size() - 8, "no footer");
    demand(footer.content.u64() == at_, "the summary does not follow the data");
    const auto offsets = footer.content.u64();
    demand(footer.content.u32() == checksum(all_.substr(at_, footer_at + 25 - at_)),
           "checksum of the summary");
    std::map<std::uint16_t, schema> known;
    std::map<std::uint16_t, mcap_channel> declared;
    std::size_t indexed = 0;
    for (auto at = at_; at < footer_at;) {
      auto x = record_at(all_, at);
      demand((at >= offsets) == (x.code == 0x0e), "an offset among others");
      at = x.end;
      if (x.code == 0x08)
        read_chunk_index(x.content, indexed++);
      else if (x.code == 0x0b)
        read_statistics(x.content);
      else if (x.code == 0x0e)
        read_offset(x.content);
      else
        read_declaration(x, known, declared);
    }
    demand(known == schemas && declared == channels, "other schemas or channels in the summary");
    demand(indexed == chunks_.size(), "not all chunks are in the summary");
  }

  void read_chunk_index(fields& x, std::size_t index) {
    if (index >= chunks_.size())
      return complain("index of no chunk");
    const auto& of = chunks_[index];
    demand(x.u64() == of.first && x.u64() == of.last, "times of a chunk in the summary");
    demand(x.u64() == of.begin && x.u64() == of.size, "place of a chunk in the summary");
    fields indices{x.octets(x.u32())};
    std::map<std::uint16_t, std::uint64_t> places;
    while (!indices.rest.empty() && !indices.ended) {
      const auto channel = indices.u16();
      places[channel] = indices.u64();
    }
    demand(places == of.indices, "indices of a chunk in the summary");
    std::uint64_t size = 0;
    for (const auto& [channel, begin] : of.indices)
      size += record_at(all_, begin).end - begin;
    demand(x.u64() == size, "size of indices");
    demand(x.text().empty(), "compressed, says the summary");
    demand(x.u64() == of.records.size() && x.u64() == of.records.size(), "size in the summary");
    demand(x.rest.empty() && !x.ended, "size of a chunk's index");
  }

  void read_statistics(fields& x) {
    demand(x.u64() == messages.size(), "count of messages");
    demand(x.u16() == schemas.size() && x.u32() == channels.size(), "counts of the summary");
    demand(x.u32() == 0 && x.u32() == 0, "attachments");
    demand(x.u32() == chunks_.size(), "count of chunks");
    const auto first = x.u64();
    const auto last = x.u64();
    demand(messages.empty() || (first == messages.front().time && last == messages.back().time),
           "times of the summary");
    fields counts{x.octets(x.u32())};
    std::uint64_t sum = 0;
    while (!counts.rest.empty() && !counts.ended) {
      counts.u16();
      sum += counts.u64();
    }
    demand(sum == messages.size() && x.rest.empty() && !x.ended, "counts of channels");
  }

  void read_offset(fields& x) {
    const auto code = static_cast<int>(x.number(1));
    const auto begin = x.u64();
    const auto end = begin + x.u64();
    auto at = begin;
    while (at < end && at < all_.size()) {
      const auto each = record_at(all_, at);
      demand(each.code == code, "an offset of another group");
      at = each.end;
    }
    demand(at == end && begin < end, "length of a group");
  }

  void check_messages() {
    std::map<std::uint16_t, std::uint32_t> next;
    std::uint64_t time = 0;
    for (const auto& each : messages) {
      demand(each.sequence == next[each.channel]++, "sequence numbers");
      demand(each.time >= time, "a message before the one in front of it");
      time = each.time;
    }
    for (const auto& each : chunks_)
      demand(each.indexed == each.held, "messages without index");
  }

  std::string_view all_;
  std::uint64_t at_ = 0; ///< behind the data
  std::vector<chunk> chunks_;
};

} // namespace rubicon::test
