-- What an island's motes say above IEEE 802.15.4, for Wireshark and tshark (docs/radio.md says how to use it).
-- The layouts are those of src/network, src/mote, src/transport, src/stream and src/synaptic, whose headers describe
-- them; all numbers are in network byte order.

local rubicon = Proto("rubicon", "Rubicon")

local am_names = {
  [0x10] = "component management",
  [0x11] = "between neighbours",
  [0x12] = "to gateway",
  [0x13] = "from gateway",
  [0x15] = "beacon",
  [0x16] = "up",
  [0x17] = "down",
  [0x18] = "flood",
  [0x19] = "channel",
  [0x1a] = "packet",
  [0x1b] = "outputs wanted",
  [0x1c] = "SMEPP Light",
}
local management_names = {
  [1] = "join request", [2] = "join reply", [3] = "join confirm", [4] = "leave",
  [5] = "keep alive", [6] = "rejoin prompt", [7] = "slot notice", [8] = "join refusal",
}
local router_names = {
  [0] = "content", [1] = "place report", [2] = "place question", [3] = "place answer",
  [4] = "sequence request",
}
local channel_names = {
  [1] = "connect", [2] = "connect ack", [3] = "end", [4] = "dead end", [5] = "data",
}
local end_names = {
  [1] = "no_room", [2] = "unreachable", [3] = "disconnected", [4] = "broken", [5] = "expired",
}
local segment_names = {
  [0] = "plain", [1] = "reliable", [2] = "acknowledgement", [5] = "hello", [6] = "busy", [7] = "refused",
}
local stream_names = {
  [1] = "SS_OPEN", [2] = "SS_OPEN_ACK", [3] = "SS_WRITE", [4] = "SS_ACK",
  [0x11] = "SYN_OPEN", [0x12] = "SYN_OPEN_ACK", [0x13] = "SYN_OPEN_NAK", [0x14] = "SYN_VECTOR",
  [0x15] = "SYN_STOP", [0x16] = "SYN_STOP_ACK",
}

local fields = {} -- by name
local all = {}
local function field(kind, name, title, ...)
  local x = ProtoField[kind]("rubicon." .. name, title, ...)
  fields[name] = x
  all[#all + 1] = x
end

field("uint8", "am", "AM type", base.HEX, am_names)
field("bytes", "payload", "Payload")

field("uint16", "beacon.sequence", "Sequence")
field("uint16", "beacon.next", "Next beacon within, in quarters of a second")
field("uint16", "beacon.root", "Root of the tree")
field("uint16", "beacon.root_sequence", "Root's sequence")
field("uint16", "beacon.parent", "Parent")
field("uint16", "beacon.cost", "Cost to the root, in 128ths of a transmission")
field("uint8", "beacon.hops", "Hops to the root", base.DEC, nil, 0x7f)
field("bool", "beacon.urgent", "Sequence number was asked for", 8, nil, 0x80)
field("bytes", "beacon.coordinates", "Virtual coordinates")
field("uint16", "beacon.clock.root", "Root of the clock")
field("uint16", "beacon.clock.sequence", "Round of the clock")
field("uint64", "beacon.clock.time", "Island time, microseconds")
field("uint32", "beacon.clock.age", "Age of the stamp, microseconds")
field("bytes", "beacon.clock.rest", "Ticks, slots and doubt of the clock")
field("uint64", "beacon.clock.network", "Network time ahead of the island's, microseconds")
field("uint16", "beacon.heard", "Hears mote")
field("uint8", "beacon.quality", "how well, in 255ths")

field("uint16", "up.origin", "Origin")
field("uint16", "up.parent", "Origin's parent")
field("uint16", "up.sequence", "Sequence")
field("uint16", "up.cost", "Sender's cost, in 128ths of a transmission")
field("uint8", "up.hops", "Hops made")
field("uint16", "down.sequence", "Sequence")
field("uint8", "down.count", "Hops of the route", base.DEC, nil, 0x7f)
field("uint8", "down.at", "Index of this hop")
field("uint16", "down.hop", "Hop")
field("uint16", "flood.origin", "Origin")
field("uint16", "flood.sequence", "Sequence")
field("uint8", "flood.hops", "Hops made")

field("uint8", "router", "Network message", base.DEC, router_names)
field("uint16", "router.mote", "Mote")
field("bytes", "router.place", "Place")
field("uint8", "content", "Content", base.HEX, am_names)

field("uint8", "management", "Component management", base.DEC, management_names)
field("uint16", "management.sequence", "Sequence")
field("uint32", "management.incarnation", "Incarnation")
field("uint32", "management.island", "Island")
field("uint16", "management.mote", "Mote")
field("uint32", "management.time_ms", "Sink's clock, milliseconds")
field("uint16", "management.slot", "Slot")
field("uint8", "management.alias", "Alias of the island")
field("bytes", "management.descriptor", "Descriptor")
field("bool", "management.battery_low", "Battery low", 8, nil, 0x01)
field("bool", "management.links_weak", "Links weak", 8, nil, 0x02)
field("uint32", "management.device", "Serial number of the hardware")

field("uint8", "fragment", "Fragment", base.DEC, nil, 0xf0)
field("uint8", "fragment.last", "Last fragment", base.DEC, nil, 0x0f)
field("uint8", "fragment.tag", "Tag of the packet")

field("uint32", "island", "Island")
field("uint16", "mote", "Mote")
field("uint16", "channel", "Channel (AM type)")

field("uint16", "segment.source", "Source mote")
field("uint8", "segment.sender", "Sender's incarnation", base.DEC, nil, 0xf0)
field("uint16", "segment.counter", "Counter", base.DEC, nil, 0x0fff)
field("uint8", "segment.am", "AM type of the message")
field("uint8", "segment.receiver", "Receiver's incarnation", base.DEC, nil, 0xf8)
field("uint8", "segment.kind", "Kind", base.DEC, segment_names, 0x07)

field("uint8", "hop", "Channel message", base.DEC, channel_names)
field("uint16", "hop.source", "Channel's source")
field("uint16", "hop.number", "Channel's number")
field("uint16", "hop.destination", "Destination")
field("bool", "hop.placed", "Place is known", 8, nil, 0x01)
field("bool", "hop.flooded", "Flooded", 8, nil, 0x02)
field("bytes", "hop.place", "Place of the destination")
field("uint8", "hop.hops", "Hops")
field("uint16", "hop.expiry", "Ends without packets after, seconds")
field("uint64", "hop.first", "First packet at, island time in microseconds")
field("uint32", "hop.interval", "Interval, milliseconds")
field("uint8", "hop.size", "Size of a packet")
field("uint32", "hop.delay", "Expected delay so far, microseconds")
field("uint8", "hop.why", "Why", base.DEC, end_names)
field("uint8", "hop.sequence", "Sequence")

field("uint8", "stream", "Stream or synaptic message", base.HEX, stream_names)
field("uint16", "stream.name", "Name")
field("uint16", "stream.sequence", "Sequence")
field("uint32", "stream.tick", "Tick")
field("uint8", "stream.first", "First value's index")
field("float", "stream.value", "Value")
field("bytes", "stream.rest", "Content")

rubicon.fields = all

-- Reads an octet after another; what is not there is not shown.
local function reader(octets, tree)
  local x = { at = 0, left = octets:len(), tree = tree }
  function x.has(size) return x.left >= size end
  function x.take(name, size, into)
    if not x.has(size) then return nil end
    local range = octets(x.at, size)
    if name then (into or x.tree):add(fields[name], range) end
    x.at, x.left = x.at + size, x.left - size
    return range
  end
  function x.peek(name, size) -- several fields may share an octet
    if x.has(size) then x.tree:add(fields[name], octets(x.at, size)) end
  end
  function x.rest(name)
    if x.left > 0 then x.take(name, x.left) end
  end
  function x.tail()
    if x.left == 0 then return nil end
    return octets(x.at, x.left)
  end
  return x
end

local function name_of(names, number, what)
  return names[number] or string.format("%s %d", what, number)
end

local function management(octets, tree)
  local x = reader(octets, tree)
  local kind = x.take("management", 1)
  if not kind then return "component management" end
  kind = kind:uint()
  if kind == 1 or kind == 3 then
    x.take("management.sequence", 2)
    x.take("management.incarnation", 4)
    x.rest("management.descriptor")
  elseif kind == 2 then
    x.take("management.sequence", 2)
    x.take("management.island", 4)
    x.take("management.mote", 2)
    x.take("management.time_ms", 4)
    x.take("management.slot", 2)
    while x.has(1) do x.take("management.alias", 1) end
  elseif kind == 5 then
    x.take("management.incarnation", 4)
    x.peek("management.battery_low", 1)
    x.take("management.links_weak", 1)
    x.take("management.device", 4)
  elseif kind == 8 then
    x.take("management.sequence", 2)
  end
  return name_of(management_names, kind, "component management")
end

local function segment(octets, tree)
  local x = reader(octets, tree)
  if not x.has(6) then
    x.rest("payload")
    return "packet"
  end
  x.take("segment.source", 2)
  x.peek("segment.sender", 1)
  local counter = x.take("segment.counter", 2):uint() % 4096
  x.take("segment.am", 1)
  x.peek("segment.receiver", 1)
  local kind = x.take("segment.kind", 1):uint() % 8
  x.rest("payload")
  return string.format("%s #%d", name_of(segment_names, kind, "segment"), counter)
end

local function packet(octets, tree)
  local x = reader(octets, tree)
  if not x.has(1) then return "packet" end
  x.peek("fragment", 1)
  local head = x.take("fragment.last", 1):uint()
  local index, last = math.floor(head / 16), head % 16
  if last > 0 then
    x.take("fragment.tag", 1)
    if index > 0 then
      x.rest("payload")
      return string.format("fragment %d of %d", index + 1, last + 1)
    end
  end
  x.take("island", 4)
  x.take("mote", 2)
  x.take("channel", 2)
  local body = x.tail()
  local what = body and segment(body, tree) or "packet"
  return last > 0 and string.format("%s, fragment 1 of %d", what, last + 1) or what
end

-- What goes through the tree, whichever way.
local function content(octets, tree)
  local x = reader(octets, tree)
  local kind = x.take("router", 1)
  if not kind then return "nothing" end
  kind = kind:uint()
  if kind == 1 then
    x.take("router.place", 3)
  elseif kind == 2 then
    x.take("router.mote", 2)
  elseif kind == 3 then
    x.take("router.mote", 2)
    x.take("router.place", 3)
  elseif kind == 0 then
    local am = x.take("content", 1)
    local rest = x.tail()
    if am and rest then
      if am:uint() == 0x10 then return management(rest, tree) end
      if am:uint() == 0x1a then return packet(rest, tree) end
      x.rest("payload")
    end
  end
  return name_of(router_names, kind, "network message")
end

local function up(octets, tree)
  local x = reader(octets, tree)
  local origin = x.take("up.origin", 2)
  x.take("up.parent", 2)
  x.take("up.sequence", 2)
  x.take("up.cost", 2)
  x.take("up.hops", 1)
  local rest = x.tail()
  return string.format("up from %s: %s", origin and origin:uint() or "?",
                       rest and content(rest, tree) or "")
end

local function down(octets, tree)
  local x = reader(octets, tree)
  x.take("down.sequence", 2)
  local count = x.take("down.count", 1)
  x.take("down.at", 1)
  if not count then return "down" end
  local size = count:uint() >= 128 and 1 or 2
  local last
  for _ = 1, count:uint() % 128 do last = x.take("down.hop", size) or last end
  local rest = x.tail()
  return string.format("down to %s: %s", last and last:uint() or "?",
                       rest and content(rest, tree) or "")
end

local function flood(octets, tree)
  local x = reader(octets, tree)
  local origin = x.take("flood.origin", 2)
  x.take("flood.sequence", 2)
  x.take("flood.hops", 1)
  local rest = x.tail()
  return string.format("flood from %s: %s", origin and origin:uint() or "?",
                       rest and content(rest, tree) or "")
end

local function stream(octets, tree)
  local x = reader(octets, tree)
  local kind = x.take("stream", 1):uint()
  if kind == 1 or kind == 2 then
    x.take("stream.name", 2)
  elseif kind == 3 or kind == 4 then
    x.take("stream.sequence", 2)
  elseif kind == 0x14 then
    x.take("stream.tick", 4)
    x.take("stream.first", 1)
    while x.has(4) do x.take("stream.value", 4) end
  elseif kind == 0x15 or kind == 0x16 then
    x.take("stream.tick", 4)
  end
  x.rest("stream.rest")
  return name_of(stream_names, kind, "data")
end

local function channel(octets, tree)
  local x = reader(octets, tree)
  local kind = x.take("hop", 1)
  local source = x.take("hop.source", 2)
  local number = x.take("hop.number", 2)
  if not number then return "channel" end
  kind = kind:uint()
  local what = name_of(channel_names, kind, "channel message")
  if kind == 1 then
    x.take("hop.destination", 2)
    x.peek("hop.placed", 1)
    x.take("hop.flooded", 1)
    x.take("hop.place", 3)
    x.take("hop.hops", 1)
    x.take("hop.expiry", 2)
    x.take("hop.first", 6)
    x.take("hop.interval", 4)
    x.take("hop.size", 1)
    x.take("hop.delay", 4)
  elseif kind == 2 then
    x.take("hop.hops", 1)
  elseif kind == 3 then
    x.take("hop.why", 1)
  elseif kind == 5 then
    x.take("hop.sequence", 1)
    local rest = x.tail()
    if rest then what = stream(rest, tree) end
  end
  return string.format("channel %d.%d: %s", source:uint(), number:uint(), what)
end

local function beacon(octets, tree)
  local x = reader(octets, tree)
  local sequence = x.take("beacon.sequence", 2)
  x.take("beacon.next", 2)
  x.take("beacon.root", 2)
  x.take("beacon.root_sequence", 2)
  x.take("beacon.parent", 2)
  x.take("beacon.cost", 2)
  x.peek("beacon.urgent", 1)
  x.take("beacon.hops", 1)
  x.take("beacon.coordinates", 26)
  x.take("beacon.clock.root", 2)
  x.take("beacon.clock.sequence", 2)
  x.take("beacon.clock.time", 6)
  x.take("beacon.clock.age", 4)
  local rest = x.take("beacon.clock.rest", 13)
  if rest and rest(4, 1):uint() >= 128 then -- it tells the network time
    x.take("beacon.clock.network", 8)
    x.take(nil, 2)
  end
  while x.has(3) do
    x.take("beacon.heard", 2)
    x.take("beacon.quality", 1)
  end
  return "beacon" .. (sequence and " #" .. sequence:uint() or "")
end

local dissectors = {
  [0x10] = management, [0x15] = beacon, [0x16] = up, [0x17] = down, [0x18] = flood, [0x19] = channel,
}

-- TinyOS's network octet, then the AM type.
local tinyos_network = 0x3f

local function dissect(octets, info, tree)
  if octets:len() < 2 or octets(0, 1):uint() ~= tinyos_network then return false end
  local am = octets(1, 1):uint()
  local below = tree:add(rubicon, octets())
  below:add(fields["am"], octets(1, 1))
  local what = name_of(am_names, am, "AM type")
  if octets:len() > 2 then
    local rest = octets(2)
    local one = dissectors[am]
    if one then
      what = one(rest, below)
    else
      below:add(fields["payload"], rest)
    end
  end
  below:append_text(", " .. what)
  info.cols.protocol = "Rubicon"
  info.cols.info = what
  return true
end

function rubicon.dissector(octets, info, tree)
  return dissect(octets, info, tree) and octets:len() or 0
end

rubicon:register_heuristic("wpan", dissect)
