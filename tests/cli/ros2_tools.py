"""What a person has of ROS 2, for tests: a rosbridge on loopback, and the commands that see its topics and services.
usage: ros2_tools.py SOCKET PORT launch rosbridge_server rosbridge_websocket_launch.xml      a rosbridge at PORT, until it is ended
       ros2_tools.py SOCKET PORT topic echo --once TOPIC                                     as ros2 prints the next message
       ros2_tools.py SOCKET PORT service call SERVICE TYPE "{data: true}"                    as ros2 prints the response
SOCKET joins the commands with the rosbridge; both speak a message of JSON a line there."""
import base64
import hashlib
import json
import os
import socket
import struct
import sys
import threading

MAGIC = "258EAFA5-E914-47DA-95CA-C5AB0DC85B11"
WAIT_S = 30
ORDER = ["header", "stamp", "sec", "nanosec", "frame_id"]  # of fields; others follow


class Rosbridge:
    """Of one client at a time. What it has sent wakes whoever waits for it."""

    def __init__(self):
        self.changed, self.client = threading.Condition(), None
        self.newest, self.counts, self.services, self.responses = {}, {}, set(), {}

    def serve(self, connection):
        try:
            stream = connection.makefile("rb")
            self.greet(stream, connection)
            with self.changed:
                self.client = connection
            while (text := read_text(stream, connection)) is not None:
                self.hear(json.loads(text))
        except (OSError, ValueError):
            pass
        finally:
            with self.changed:
                self.client, self.services = None, set()
            connection.close()

    @staticmethod
    def greet(stream, connection):
        key = ""
        while (line := stream.readline().strip()) != b"":
            if line.lower().startswith(b"sec-websocket-key:"):
                key = line.split(b":", 1)[1].strip().decode()
        accept = base64.b64encode(hashlib.sha1((key + MAGIC).encode()).digest()).decode()
        connection.sendall(("HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                            f"Sec-WebSocket-Accept: {accept}\r\n\r\n").encode())

    def hear(self, x):
        with self.changed:
            if x["op"] == "publish":
                self.newest[x["topic"]] = x["msg"]
                self.counts[x["topic"]] = self.counts.get(x["topic"], 0) + 1
            elif x["op"] == "advertise_service":
                self.services.add(x["service"])
            elif x["op"] == "service_response":
                self.responses[x["id"]] = x
            self.changed.notify_all()

    def echo(self, topic):
        """The next message; a later subscriber receives one that is latched."""
        with self.changed:
            return self.changed.wait_for(lambda: self.newest.get(topic), WAIT_S)

    def call(self, service, arguments):
        with self.changed:
            if not self.changed.wait_for(lambda: service in self.services, WAIT_S):
                return None
            number = f"call-{len(self.responses)}"
            send_text(self.client, json.dumps({"op": "call_service", "id": number, "service": service, "args": arguments}))
            return self.changed.wait_for(lambda: self.responses.get(number), WAIT_S)


def read_text(stream, connection):
    """The next text of a client, or nothing at its end. Pings are answered."""
    while len(head := stream.read(2)) == 2:
        kind, size = head[0] & 15, head[1] & 127
        if size > 125:
            size = struct.unpack(">H", stream.read(2))[0] if size == 126 else struct.unpack(">Q", stream.read(8))[0]
        mask = stream.read(4)
        content = bytes(octet ^ mask[i % 4] for i, octet in enumerate(stream.read(size)))
        if kind == 1:
            return content.decode()
        if kind == 8:
            return None
        if kind == 9:
            connection.sendall(bytes([0x8a, len(content)]) + content)
    return None


def send_text(connection, text):
    octets = text.encode()
    size = bytes([len(octets)]) if len(octets) < 126 else bytes([126]) + struct.pack(">H", len(octets))
    connection.sendall(b"\x81" + size + octets)


def launch(path, port):
    bridge, commands = Rosbridge(), socket.socket(socket.AF_UNIX)
    commands.bind(path)
    commands.listen()
    web = socket.create_server(("127.0.0.1", port))

    def answer(connection):
        with connection, connection.makefile("rw") as stream:
            words = json.loads(stream.readline())
            stream.write(json.dumps(getattr(bridge, words[0])(*words[1:])) + "\n")

    def accept_all(listener, serve):
        while True:
            threading.Thread(target=serve, args=(listener.accept()[0],), daemon=True).start()

    threading.Thread(target=accept_all, args=(commands, answer), daemon=True).start()
    try:
        accept_all(web, bridge.serve)
    except KeyboardInterrupt:
        os.unlink(path)


def ask(path, *words):
    with socket.socket(socket.AF_UNIX) as x:
        x.connect(path)
        with x.makefile("rw") as stream:
            stream.write(json.dumps(words) + "\n")
            stream.flush()
            found = json.loads(stream.readline())
    return found or sys.exit(f"no answer to {' '.join(map(str, words))}")


def yaml_lines(x, indent=""):
    for name, value in sorted(x.items(), key=lambda each: ORDER.index(each[0]) if each[0] in ORDER else len(ORDER)):
        if isinstance(value, dict):
            yield f"{indent}{name}:"
            yield from yaml_lines(value, indent + "  ")
        else:
            yield f"{indent}{name}: {value}"


def main():
    path, port, words = sys.argv[1], int(sys.argv[2]), sys.argv[3:]
    if words[:1] == ["launch"]:
        launch(path, port)
    elif words[:3] == ["topic", "echo", "--once"]:
        print(*yaml_lines(ask(path, "echo", words[3])), "---", sep="\n")
    elif words[:2] == ["service", "call"]:
        service, kind, text = words[2:]
        data = {"true": True, "false": False}[text.strip("{} ").removeprefix("data:").strip()]
        name = kind.replace("/", ".")
        print(f"requester: making request: {name}_Request(data={data})\n")
        values = ask(path, "call", service, {"data": data})["values"]
        print(f"response:\n{name}_Response(success={values['success']}, message={values['message']!r})\n")
    else:
        sys.exit(__doc__)


if __name__ == "__main__":
    main()
