#include "exports/mcap_schemas.hpp"

namespace rubicon::exports {

namespace {

constexpr std::string_view encoding = "jsonschema";

constexpr std::string_view message_text = R"({
"type":"object","title":"A message that has arrived, or is lost, refused or, at the end, in flight",
"properties":{
"message":{"type":"string"},"from":{"type":"string"},"to":{"type":"string"},
"kind":{"type":"string","enum":["message","channel","tunnel"]},
"sent_s":{"type":"number"},"outcome":{"type":"string"},"took_s":{"type":"number"},
"why":{"type":"string"},"cause":{"type":"string"},"where":{"type":"string"},
"repeats":{"type":"object","properties":{"radio":{"type":"integer"},"serial":{"type":"integer"},
"peis":{"type":"integer"},"transport":{"type":"integer"}}}}})";

constexpr std::string_view tuple_text = R"({
"type":"object","title":"A tuple that was set or deleted",
"properties":{
"key":{"type":"string"},"owner":{"type":"string"},"value":{"type":"string"},
"by":{"type":"string"},"deleted":{"type":"boolean"}}})";

constexpr std::string_view places_text = R"({
"type":"object","title":"Where motes and sinks are",
"properties":{"motes":{"type":"array","items":{"type":"object","properties":{
"mote":{"type":"string"},"x_m":{"type":"number"},"y_m":{"type":"number"}}}}}})";

constexpr std::string_view links_text = R"({
"type":"object","title":"Each mote's link to its parent, and its estimates of all neighbours",
"properties":{
"motes":{"type":"array","items":{"type":"object","properties":{
"mote":{"type":"string"},"alive":{"type":"boolean"},"used_mah":{"type":"number"},
"parent":{"type":"string"},"hops":{"type":"integer"},"signal_dbm":{"type":"number"},
"etx":{"type":"number"}}}},
"neighbours":{"type":"array","items":{"type":"object","properties":{
"mote":{"type":"string"},"neighbour":{"type":"string"},"etx":{"type":"number"}}}}}})";

// Foxglove and Rerun know these by their names (https://docs.foxglove.dev/docs/sdk/schemas).
constexpr std::string_view log_text = R"({
"type":"object","title":"foxglove.Log",
"properties":{
"timestamp":{"type":"object","title":"time","properties":{"sec":{"type":"integer"},
"nsec":{"type":"integer"}}},
"level":{"type":"integer"},"message":{"type":"string"},"name":{"type":"string"},
"file":{"type":"string"},"line":{"type":"integer"}}})";

constexpr std::string_view scene_text = R"({
"type":"object","title":"foxglove.SceneUpdate",
"$defs":{
"time":{"type":"object","title":"time","properties":{"sec":{"type":"integer"},
"nsec":{"type":"integer"}}},
"duration":{"type":"object","title":"duration","properties":{"sec":{"type":"integer"},
"nsec":{"type":"integer"}}},
"vector":{"type":"object","properties":{"x":{"type":"number"},"y":{"type":"number"},
"z":{"type":"number"}}},
"quaternion":{"type":"object","properties":{"x":{"type":"number"},"y":{"type":"number"},
"z":{"type":"number"},"w":{"type":"number"}}},
"pose":{"type":"object","properties":{"position":{"$ref":"#/$defs/vector"},
"orientation":{"$ref":"#/$defs/quaternion"}}},
"color":{"type":"object","properties":{"r":{"type":"number"},"g":{"type":"number"},
"b":{"type":"number"},"a":{"type":"number"}}}},
"properties":{
"deletions":{"type":"array","items":{"type":"object","properties":{
"timestamp":{"$ref":"#/$defs/time"},"type":{"type":"integer"},"id":{"type":"string"}}}},
"entities":{"type":"array","items":{"type":"object","properties":{
"timestamp":{"$ref":"#/$defs/time"},"frame_id":{"type":"string"},"id":{"type":"string"},
"lifetime":{"$ref":"#/$defs/duration"},"frame_locked":{"type":"boolean"},
"metadata":{"type":"array","items":{"type":"object","properties":{"key":{"type":"string"},
"value":{"type":"string"}}}},
"arrows":{"type":"array"},"cubes":{"type":"array"},"cylinders":{"type":"array"},
"triangles":{"type":"array"},"models":{"type":"array"},
"spheres":{"type":"array","items":{"type":"object","properties":{
"pose":{"$ref":"#/$defs/pose"},"size":{"$ref":"#/$defs/vector"},
"color":{"$ref":"#/$defs/color"}}}},
"lines":{"type":"array","items":{"type":"object","properties":{
"type":{"type":"integer"},"pose":{"$ref":"#/$defs/pose"},"thickness":{"type":"number"},
"scale_invariant":{"type":"boolean"},
"points":{"type":"array","items":{"$ref":"#/$defs/vector"}},
"color":{"$ref":"#/$defs/color"},
"colors":{"type":"array","items":{"$ref":"#/$defs/color"}},
"indices":{"type":"array","items":{"type":"integer"}}}}},
"texts":{"type":"array","items":{"type":"object","properties":{
"pose":{"$ref":"#/$defs/pose"},"billboard":{"type":"boolean"},"font_size":{"type":"number"},
"scale_invariant":{"type":"boolean"},"color":{"$ref":"#/$defs/color"},
"text":{"type":"string"}}}}}}}}})";

} // namespace

const topic messages_topic{"/messages", {"rubicon.Message", encoding, message_text}};
const topic tuples_topic{"/tuples", {"rubicon.Tuple", encoding, tuple_text}};
const topic events_topic{"/events", {"foxglove.Log", encoding, log_text}};
const topic places_topic{"/places", {"rubicon.Places", encoding, places_text}};
const topic links_topic{"/links", {"rubicon.Links", encoding, links_text}};
const topic scene_topic{"/scene", {"foxglove.SceneUpdate", encoding, scene_text}};

} // namespace rubicon::exports
