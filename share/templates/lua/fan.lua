-- A fan with hysteresis, and a thermometer with a dead band. The fan is on from `on_at` counts until the
-- temperature is `off_at` counts or less; the temperature is sent to the gateway of the island when it
-- differs by `band` counts from what was sent last. All three are `settings` of the file.
local CHANNEL = 1 -- of the messages, by which a proxy knows them
local is_on, sent = false, nil
local readings, messages = 0, 0

local function control(count)
  local wanted = count >= settings.on_at or is_on and count > settings.off_at
  if wanted ~= is_on then
    is_on = wanted
    notify(is_on and "on at " or "off at ", count)
    layer.set_actuator("fan", is_on and 1 or 0)
  end
end

local function report(count)
  if sent and math.abs(count - sent) < settings.band then
    return
  end
  local octets = string.pack(">i2B", count, is_on and 1 or 0)
  if layer.send(OWN_ISLAND, GATEWAY, octets, CHANNEL, true) then
    sent, messages = count, messages + 1
    figure("messages", messages)
  end
end

function joined(island, mote, success)
  sent = nil -- what was sent before is not certain to be known
end

function ack(success)
  if not success then
    sent = nil
  end
end

function transducersRead(counts)
  readings = readings + 1
  figure("readings", readings)
  control(counts[1])
  report(counts[1])
end

every(1, function() layer.read_transducers{"temperature"} end)
