-- A controller with two states: receives temperatures in counts and switches the actuator of the mote
-- `to`, on at `on_at` or more and off at `off_at` or less. In between it stays as it is. A command that
-- is not acknowledged is sent again.
local READINGS, COMMANDS, RETRY_AFTER = 30, 2, 5
local is_on = false
local command -- the number of the message that has not been acknowledged
local switched = 0

local function send_state()
  command = layer.send(OWN_ISLAND, settings.to, is_on and "\1" or "\0", COMMANDS, true)
  if not command then
    after(RETRY_AFTER, send_state)
  end
end

function receive(island, mote, octets, am_type, success)
  if am_type ~= READINGS or not success or #octets < 2 then
    return
  end
  local count = string.unpack(">i2", octets)
  local wanted = count >= settings.on_at or is_on and count > settings.off_at
  if wanted == is_on then
    return
  end
  is_on, switched = wanted, switched + 1
  figure("switched", switched)
  notify(is_on and "on at " or "off at ", count)
  send_state()
end

function ackOf(number, success)
  if number == command and not success then
    after(RETRY_AFTER, send_state)
  end
end

assert(layer.provide(READINGS))
