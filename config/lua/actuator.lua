-- Sets the actuator `fan` to the first octet of each message on channel 2, and answers the gateway with
-- its state on the same channel.
local CHANNEL = 2

function receive(island, mote, octets)
  if #octets > 0 then
    layer.set_actuator("fan", octets:byte())
  end
end

function actuatorChanged(name, state, obeyed)
  layer.send(OWN_ISLAND, GATEWAY, string.char(state), CHANNEL, true)
end

assert(layer.provide(CHANNEL))
