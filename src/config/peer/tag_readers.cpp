#include <utility>

#include "config/file_readers.hpp"
#include "config/island/model_readers.hpp"
#include "rfid/reader_keys.hpp"

namespace rubicon::config {

rfid::reader_config read_rfid_reader(table_reader& in, std::string_view peer_name) {
  rfid::reader_config out;
  out.name = peer_name;
  in.all(out);
  return out;
}

std::vector<tag_description> read_tags(table_reader& root) {
  std::vector<tag_description> out;
  name_claims ids;
  root.tables("tag", "[[tag]]", "tagged objects, which readers perceive", [&](table_reader& in) {
    tag_description found;
    if (in.required("id", name_text{}, found.id, "unique among tags"))
      ids.claim(found.id, "tag", in.at("id"), in.problems());
    found.id = folded(found.id);
    in.optional("memory", hex_octets{}, found.memory,
                {"its user memory, which readers read", "none"});
    const bool has_place = in.required_if(!in.has("path"), "position_m", place{}, found.place,
                                          {"position", "the first of `path`"});
    read_path(in, has_place, found.place, found.path);
    out.push_back(std::move(found));
  });
  return out;
}

} // namespace rubicon::config
