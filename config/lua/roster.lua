-- On the gateway's PC: counts the motes that have joined.
local motes = {}

function moteJoined(mote)
  motes[mote] = (motes[mote] or 0) + 1
  local list = {}
  for each in pairs(motes) do
    list[#list + 1] = each
  end
  figure("motes", #list)
  notify("motes so far:", table.concat(list, " "))
end
