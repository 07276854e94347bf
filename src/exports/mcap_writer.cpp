#include "exports/mcap_writer.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <concepts>
#include <utility>

namespace rubicon::exports {

namespace {

constexpr std::string_view magic = "\x89MCAP0\r\n";

namespace code {
constexpr char header = 0x01;
constexpr char footer = 0x02;
constexpr char schema = 0x03;
constexpr char channel = 0x04;
constexpr char message = 0x05;
constexpr char chunk = 0x06;
constexpr char message_index = 0x07;
constexpr char chunk_index = 0x08;
constexpr char statistics = 0x0b;
constexpr char summary_offset = 0x0e;
constexpr char data_end = 0x0f;
} // namespace code

/// Least significant octet first.
template <std::unsigned_integral Number>
void put(std::string& out, Number x) {
  for (std::size_t i = 0; i < sizeof(Number); ++i)
    out += static_cast<char>(static_cast<std::uint8_t>(x >> (8U * i)));
}

void put_text(std::string& out, std::string_view x) {
  put(out, static_cast<std::uint32_t>(x.size()));
  out += x;
}

std::string record_of(char what, std::string_view content) {
  std::string out(1, what);
  put(out, std::uint64_t{content.size()});
  return out += content;
}

constexpr std::array<std::uint32_t, 256> crc_table = [] {
  std::array<std::uint32_t, 256> all{};
  for (std::uint32_t i = 0; i < all.size(); ++i) {
    auto x = i;
    for (int bit = 0; bit < 8; ++bit)
      x = (x & 1U) != 0 ? x >> 1U ^ 0xedb88320U : x >> 1U;
    all[i] = x;
  }
  return all;
}();

} // namespace

std::uint32_t crc32(std::string_view octets, std::uint32_t before) {
  auto x = ~before;
  for (const auto c : octets)
    x = x >> 8U ^ crc_table[(x ^ static_cast<std::uint8_t>(c)) & 0xffU];
  return ~x;
}

void mcap_writer::span::add(std::uint64_t at) {
  first = count == 0 ? at : std::min(first, at);
  last = std::max(last, at);
  ++count;
}

mcap_writer::mcap_writer(octets_out out) : out_(std::move(out)) {
  std::string header;
  put_text(header, ""); // no profile
  put_text(header, "rubicon");
  write(std::string(magic) + record_of(code::header, header));
}

void mcap_writer::write(std::string_view octets) {
  crc_ = crc32(octets, crc_);
  written_ += octets.size();
  out_(octets);
}

mcap_writer::channel_id mcap_writer::add_channel(std::string_view topic,
                                                 const mcap_schema& schema) {
  counts_.push_back(0);
  assert(counts_.size() < 0xffff);
  const auto id = static_cast<channel_id>(counts_.size()); // of the schema too
  std::string content;
  put(content, id);
  put_text(content, schema.name);
  put_text(content, schema.encoding);
  put_text(content, schema.text);
  const auto schema_record = record_of(code::schema, content);
  content.clear();
  put(content, id);
  put(content, id);
  put_text(content, topic);
  put_text(content, "json");
  put_text(content, ""); // no metadata
  const auto channel_record = record_of(code::channel, content);
  (chunk_ += schema_record) += channel_record;
  schemas_ += schema_record;
  channels_ += channel_record;
  return id;
}

void mcap_writer::add(channel_id to, instant at, std::string_view message) {
  assert(to > 0 && to <= counts_.size() && at >= instant{});
  const auto time = static_cast<std::uint64_t>(at.time_since_epoch().count());
  std::string content;
  put(content, to);
  put(content, static_cast<std::uint32_t>(counts_[to - 1U]++));
  put(content, time); // logged
  put(content, time); // published
  content += message;
  chunk_index_[to].emplace_back(time, chunk_.size());
  chunk_ += record_of(code::message, content);
  chunk_times_.add(time);
  times_.add(time);
  if (chunk_.size() >= chunk_octets)
    end_chunk();
}

void mcap_writer::end_chunk() {
  if (chunk_.empty())
    return;
  chunk_place place;
  place.times = chunk_times_;
  place.begin = written_;
  place.content_octets = chunk_.size();
  std::string head;
  put(head, chunk_times_.first);
  put(head, chunk_times_.last);
  put(head, std::uint64_t{chunk_.size()});
  put(head, crc32(chunk_));
  put_text(head, ""); // not compressed
  put(head, std::uint64_t{chunk_.size()});
  std::string begin(1, code::chunk);
  put(begin, std::uint64_t{head.size() + chunk_.size()});
  write(begin + head);
  write(chunk_);
  place.octets = written_ - place.begin;
  write_index(place);
  chunks_.push_back(std::move(place));
  chunk_.clear();
  chunk_times_ = {};
}

void mcap_writer::write_index(chunk_place& place) {
  const auto begin = written_;
  for (const auto& [channel, messages] : chunk_index_) {
    place.indices[channel] = written_;
    std::string content;
    put(content, channel);
    put(content, static_cast<std::uint32_t>(messages.size() * 16));
    for (const auto& [time, offset] : messages) {
      put(content, time);
      put(content, offset);
    }
    write(record_of(code::message_index, content));
  }
  place.index_octets = written_ - begin;
  chunk_index_.clear();
}

void mcap_writer::finish() {
  end_chunk();
  std::string end;
  put(end, crc_);
  write(record_of(code::data_end, end));
  write_summary();
}

void mcap_writer::write_summary() {
  const auto begin = written_;
  crc_ = 0;
  std::string offsets;
  write(schemas_);
  write_offset(code::schema, begin, offsets);
  auto group = written_;
  write(channels_);
  write_offset(code::channel, group, offsets);
  group = written_;
  write(record_of(code::statistics, statistics()));
  write_offset(code::statistics, group, offsets);
  group = written_;
  for (const auto& x : chunks_) {
    std::string content;
    for (const auto number : {x.times.first, x.times.last, x.begin, x.octets})
      put(content, number);
    put(content, static_cast<std::uint32_t>(x.indices.size() * 10));
    for (const auto& [channel, offset] : x.indices) {
      put(content, channel);
      put(content, offset);
    }
    put(content, x.index_octets);
    put_text(content, ""); // not compressed
    put(content, x.content_octets);
    put(content, x.content_octets);
    write(record_of(code::chunk_index, content));
  }
  write_offset(code::chunk_index, group, offsets);
  const auto offsets_begin = written_;
  write(offsets);
  std::string footer(1, code::footer);
  put(footer, std::uint64_t{20});
  put(footer, begin);
  put(footer, offsets_begin);
  write(footer);
  std::string crc;
  put(crc, crc_);
  write(crc + std::string(magic));
}

void mcap_writer::write_offset(char what, std::uint64_t begin, std::string& offsets) {
  if (written_ == begin) // there is none of them
    return;
  std::string content(1, what);
  put(content, begin);
  put(content, written_ - begin);
  offsets += record_of(code::summary_offset, content);
}

std::string mcap_writer::statistics() const {
  std::string out;
  put(out, times_.count);
  put(out, static_cast<std::uint16_t>(counts_.size())); // schemas
  put(out, static_cast<std::uint32_t>(counts_.size())); // channels
  put(out, std::uint32_t{0});                           // attachments
  put(out, std::uint32_t{0});                           // metadata
  put(out, static_cast<std::uint32_t>(chunks_.size()));
  put(out, times_.first);
  put(out, times_.last);
  std::uint32_t octets = 0;
  std::string counts;
  for (std::size_t i = 0; i < counts_.size(); ++i)
    if (counts_[i] > 0) {
      put(counts, static_cast<channel_id>(i + 1));
      put(counts, counts_[i]);
      octets += 10;
    }
  put(out, octets);
  return out += counts;
}

} // namespace rubicon::exports
