#include <utility>

#include "config/file_readers.hpp"
#include "config/island/model_readers.hpp"
#include "rfid/reader_keys.hpp"

namespace rubicon::config {

namespace {

auto tag_keys() {
  return keys::of(keys::required("id", &tag_description::id, name_text{}, "unique among tags"),
                  keys::optional("memory", &tag_description::memory, hex_octets{},
                                 {"its user memory, which readers read", "none"}));
}

auto tag_place_keys(bool is_required) {
  return keys::of(keys::required_if(is_required, "position_m", &tag_description::place, place{},
                                    {"position", "the first of `path`"}));
}

} // namespace

rfid::reader_config read_rfid_reader(table_reader& in, std::string_view peer_name) {
  rfid::reader_config out;
  out.name = peer_name;
  in.all(out);
  return out;
}

std::vector<tag_description> read_tags(table_reader& root) {
  std::vector<tag_description> out;
  name_uniqueness ids;
  root.tables("tag", "[[tag]]", "tagged objects, which readers perceive", [&](table_reader& in) {
    tag_description found;
    in.all(found, tag_keys());
    if (in.is_good("id"))
      ids.add(found.id, "tag", in.at("id"), in.problems());
    found.id = folded(found.id);
    in.all(found, tag_place_keys(!in.has("path")));
    read_path(in, in.is_good("position_m"), found.place, found.path);
    out.push_back(std::move(found));
  });
  return out;
}

} // namespace rubicon::config
