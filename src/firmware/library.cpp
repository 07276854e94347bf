#include "firmware/library.hpp"

#include <algorithm>
#include <optional>
#include <vector>

#include "core/codec.hpp"
#include "firmware/rubicon_mote.h"

namespace rubicon::firmware {

namespace {

// ELF, as the System V ABI has it: file header, program headers, section headers, symbols.
constexpr std::size_t header_octets = 64;
constexpr std::size_t segment_octets = 56;
constexpr std::size_t section_octets = 64;
constexpr std::size_t symbol_octets = 24;
constexpr std::uint16_t type_shared = 3;
constexpr std::uint32_t segment_load = 1;
constexpr std::uint32_t section_dynamic_symbols = 11;
constexpr std::size_t headers_max = 4096;
constexpr std::size_t symbols_max = 1 << 20;

#if defined(__x86_64__)
constexpr std::uint16_t machine = 62;
#elif defined(__aarch64__)
constexpr std::uint16_t machine = 183;
#elif defined(__riscv)
constexpr std::uint16_t machine = 243;
#else
constexpr std::uint16_t machine = 0; // whatever the loader accepts
#endif

using octets_or_none = std::optional<byte_view>;

octets_or_none part(byte_view all, std::uint64_t offset, std::uint64_t count) {
  if (offset > all.size() || count > all.size() - offset)
    return {};
  return all.subspan(static_cast<std::size_t>(offset), static_cast<std::size_t>(count));
}

struct file_header {
  std::uint64_t segments_at = 0;
  std::uint64_t sections_at = 0;
  std::uint16_t segments = 0;
  std::uint16_t sections = 0;
};

struct section {
  std::uint32_t type = 0;
  std::uint64_t at = 0;
  std::uint64_t octets = 0;
  std::uint32_t linked = 0;
};

std::variant<file_header, std::string> read_header(byte_view file) {
  const auto octets = part(file, 0, header_octets);
  constexpr std::uint8_t magic[] = {0x7f, 'E', 'L', 'F', 2, 1};
  if (!octets || !std::equal(std::begin(magic), std::end(magic), octets->begin()))
    return "is no shared library (ELF, 64 bits)";
  byte_reader in(octets->subspan(16));
  const auto type = in.little<std::uint16_t>();
  const auto made_for = in.little<std::uint16_t>();
  if (type != type_shared)
    return "is no shared library: link it with -shared";
  if (machine != 0 && made_for != machine)
    return "is a shared library for another processor";
  in.skip(4 + 8); // version, entry
  file_header x;
  x.segments_at = in.little<std::uint64_t>();
  x.sections_at = in.little<std::uint64_t>();
  in.skip(4 + 2 + 2); // flags, sizes of headers, which are known
  x.segments = in.little<std::uint16_t>();
  in.skip(2);
  x.sections = in.little<std::uint16_t>();
  return x;
}

std::optional<section> read_section(byte_view file, const file_header& header, std::size_t number) {
  if (number >= header.sections || number >= headers_max)
    return {};
  const auto octets = part(file, header.sections_at, header.sections * section_octets);
  if (!octets)
    return {};
  byte_reader in(octets->subspan(number * section_octets, section_octets));
  section x;
  in.skip(4);
  x.type = in.little<std::uint32_t>();
  in.skip(8 + 8); // flags, address
  x.at = in.little<std::uint64_t>();
  x.octets = in.little<std::uint64_t>();
  x.linked = in.little<std::uint32_t>();
  return x;
}

/// The octets of the file that are loaded to an address.
octets_or_none loaded_at(byte_view file, const file_header& header, std::uint64_t address,
                         std::uint64_t count) {
  const auto octets = part(file, header.segments_at, header.segments * segment_octets);
  if (!octets)
    return {};
  for (std::size_t i = 0; i < header.segments; ++i) {
    byte_reader in(octets->subspan(i * segment_octets, segment_octets));
    const auto type = in.little<std::uint32_t>();
    in.skip(4);
    const auto at = in.little<std::uint64_t>();
    const auto begin = in.little<std::uint64_t>();
    in.skip(8);
    const auto in_file = in.little<std::uint64_t>();
    if (type == segment_load && address >= begin && address - begin < in_file &&
        count <= in_file - (address - begin) && at <= file.size())
      return part(file, at + (address - begin), count);
  }
  return {};
}

bool is_named(byte_view names, std::uint64_t at, std::string_view name) {
  const auto text = part(names, at, name.size() + 1);
  return text && std::equal(name.begin(), name.end(), text->begin()) && text->back() == 0;
}

/// Where the exported object is loaded to.
std::optional<std::uint64_t> address_of(byte_view file, const file_header& header) {
  for (std::size_t i = 0; i < header.sections && i < headers_max; ++i) {
    const auto symbols = read_section(file, header, i);
    if (!symbols || symbols->type != section_dynamic_symbols)
      continue;
    const auto names = read_section(file, header, symbols->linked);
    const auto all = part(file, symbols->at, symbols->octets);
    const auto texts = names ? part(file, names->at, names->octets) : octets_or_none();
    if (!all || !texts)
      return {};
    const auto count = std::min(all->size() / symbol_octets, symbols_max);
    for (std::size_t n = 0; n < count; ++n) {
      byte_reader in(all->subspan(n * symbol_octets, symbol_octets));
      const auto name = in.little<std::uint32_t>();
      in.skip(2);
      const auto defined_in = in.little<std::uint16_t>();
      const auto value = in.little<std::uint64_t>();
      const auto octets = in.little<std::uint64_t>();
      if (defined_in != 0 && octets >= 2 * sizeof(std::uint32_t) &&
          is_named(*texts, name, exported_name))
        return value;
    }
  }
  return {};
}

/// What is wrong with the exported object, which is named.
std::string quoted(std::string what) {
  what += '`';
  what += exported_name;
  return what += '`';
}

} // namespace

std::variant<library_facts, std::string> inspect(byte_view file) {
  const auto found = read_header(file);
  if (const auto* wrong = std::get_if<std::string>(&found))
    return *wrong;
  const auto& header = std::get<file_header>(found);
  const auto address = address_of(file, header);
  if (!address)
    return quoted("exports no object ");
  const auto octets = loaded_at(file, header, *address, 2 * sizeof(std::uint32_t));
  if (!octets)
    return quoted("has no content for ");
  byte_reader in(*octets);
  const auto version = in.little<std::uint32_t>();
  return library_facts{version, in.little<std::uint32_t>()};
}

std::string refusal(const library_facts& x) {
  if (x.version == RUBICON_MOTE_VERSION)
    return {};
  return "is for version " + std::to_string(x.version) + " of rubicon_mote.h; this host has " +
         std::to_string(RUBICON_MOTE_VERSION);
}

} // namespace rubicon::firmware
