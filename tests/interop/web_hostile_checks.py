"""Checks of clients and files that nobody means well: WebSocket frames that are none, a thousand connections, files that are something else, a
browser that goes in the middle of a command."""
import json
import os
import pathlib
import socket
import struct

from kit import PATIENCE, check, first_plant_file, command, program, require, running, running_page, scratch, until
from web_checks import PageClient, Watcher, ask, page_of
from web_project_checks import DEVICES, new_project


def frame(first, data=b"", size=None, mask=bytes(4)):
    """A frame of a client; a mask of zeros leaves the data as they are."""
    size = len(data) if size is None else size
    length = bytes([0x80 | size]) if size < 126 else b"\xFE" + struct.pack("!H", size) if size < 65536 else b"\xFF" + struct.pack("!Q", size)
    return bytes([first]) + length + mask + data


def close_code(watcher):
    """What the server closes with; None: it goes without a word. Events before it do not matter."""
    try:
        while True:
            head = watcher.file.read(2)
            if len(head) < 2:
                return None
            size = head[1] & 0x7F
            if size == 126:
                size, = struct.unpack("!H", watcher.file.read(2))
            elif size == 127:
                size, = struct.unpack("!Q", watcher.file.read(8))
            data = watcher.file.read(size)
            if head[0] == 0x88:
                return struct.unpack("!H", data[:2])[0] if data else None
    except ConnectionResetError:
        return None


@check
def web_frames_that_are_none_end_their_connection_alone():
    with running(first_plant_file(), operational=[1], words=["--web"]) as plant:
        _, port = page_of(plant)
        steady = Watcher(port)
        wrong = {
            "reserved bits": (frame(0xF1, b"{}"), 1002),
            "an unknown kind": (frame(0x83, b"{}"), 1002),
            "an unknown control frame": (frame(0x8B), 1002),
            "a ping of 126 bytes": (b"\x89\xFE\x00\x7E" + bytes(4 + 126), 1002),
            "a ping in parts": (frame(0x09, b"x"), 1002),
            "a continuation of nothing": (frame(0x80, b"{}"), 1002),
            "a text inside of a text": (frame(0x01, b"{") + frame(0x81, b"}"), 1002),
            "a frame without a mask": (b"\x81\x02{}", 1002),
            "a text that is no UTF-8": (frame(0x81, b"\xC3\x28"), 1007),
            "a close of one byte": (frame(0x88, b"\x03"), 1002),
            "a close with a code that nobody may send": (frame(0x88, struct.pack("!H", 1005)), 1002),
            "a close with a reason that is no UTF-8": (frame(0x88, struct.pack("!H", 1000) + b"\xFF"), 1007),
            "2^63 bytes": (b"\x81\xFF" + struct.pack("!Q", 1 << 63) + bytes(4), 1009),
            "2^64 - 1 bytes": (b"\x81\xFF" + b"\xFF" * 8 + bytes(4), 1009),
            "a length that is longer than it needs to be": (b"\x81\xFE\x00\x02" + bytes(4) + b"{}", 1002),
        }
        for name, (data, code) in wrong.items():
            watcher = Watcher(port)
            watcher.socket.sendall(data)
            found = close_code(watcher)
            require(found in (code, None, 1002), (name, found))
            watcher.socket.close()
        # Half a head, half a text, and nobody there any more.
        for data in (b"\x81", b"\x81\xFE\x01", frame(0x81, b"{", size=100), frame(0x01, b"{"), frame(0x89, b"", size=5)):
            watcher = Watcher(port)
            watcher.socket.sendall(data)
            watcher.socket.close()
        # What is allowed, and no command: it is ignored.
        for data in (frame(0x82, bytes(range(256))), frame(0x81), frame(0x81, b"[]"), frame(0x81, b"\"x\""), frame(0x81, b"{" * 500), frame(0x8A, b"?"), frame(0x81, b"1e999"),
                     frame(0x81, b"{\"views\": [{\"words\": 1e300}]}"), frame(0x81, b"{\"do\": 5, \"id\": -1}")):
            watcher = Watcher(port)
            watcher.socket.sendall(data + frame(0x89, b"still there"))
            while True:
                head = watcher.file.read(2)
                require(len(head) == 2, (data[:20], "it was ended"))
                size = head[1] & 0x7F
                if size == 126:
                    size, = struct.unpack("!H", watcher.file.read(2))
                body = watcher.file.read(size)
                if head[0] == 0x8A:
                    require(body == b"still there", body)
                    break
            watcher.socket.close()
        before = steady.event(lambda e: e["event"] == "state")
        require(steady.event(lambda e: e["event"] == "state" and e["t"] > before["t"]), "nobody else gets anything any more")
        require(plant.stop()[0] == 0, "the run did not end as asked")


def memory_of(process):
    """MB of it that are in memory."""
    line = next(line for line in pathlib.Path(f"/proc/{process.pid}/status").read_text().splitlines() if line.startswith("VmRSS"))
    return int(line.split()[1]) / 1024


@check
def web_a_thousand_connections_at_once():
    """As many as may be are served, the others are told so or end; the memory has a bound, and afterwards there is room again."""
    with running(first_plant_file(), operational=[1], words=["--web"]) as plant:
        _, port = page_of(plant)
        steady = Watcher(port)
        before = memory_of(plant.process)
        many = []
        for _ in range(1000):
            one = socket.create_connection(("127.0.0.1", port), PATIENCE)
            one.sendall(f"GET /events HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nOrigin: http://127.0.0.1:{port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                        "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n".encode())
            many.append(one)
        served = 0
        for one in many:
            try:
                served += one.recv(12) == b"HTTP/1.1 101"
            except ConnectionResetError:
                pass
        state = steady.event(lambda e: e["event"] == "state")
        require(steady.event(lambda e: e["event"] == "state" and e["t"] > state["t"] + 1), "who was there first gets nothing any more")
        grown = memory_of(plant.process) - before
        require(0 < served <= 1000 and grown < 200, (served, grown))
        for one in many:
            one.close()
        until(lambda: ask(port, f"GET / HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n").startswith(b"HTTP/1.1 200"), "there is no room afterwards")
        print(f"    {served} of 1000 are served at once, {grown:.1f} MB for them")
        code, errors = plant.stop()
        require(code == 0, errors)


@check
def web_files_of_a_project_that_are_something_else():
    """A FIFO, a folder, a device, a link to nowhere or in a circle in place of a file while the page runs: a sentence that names it, nothing is
    changed, nothing waits for ever. A link to a file is not followed: a folder from somebody else would lead anywhere."""
    folder = new_project("web-other-files")
    command(program, "project", "add", folder, DEVICES / "encoder.eds", "--bit-rate", "250k")
    (dcf,), kept = folder.glob("*.dcf"), scratch / "kept.dcf"
    content = dcf.read_bytes()
    with running_page(folder, "--no-devices") as page:
        owner = PageClient(page)
        for name, make in (("a FIFO", os.mkfifo), ("a folder", os.mkdir), ("a link to nowhere", lambda path: path.symlink_to("nowhere")),
                           ("a link to itself", lambda path: path.symlink_to(path)), ("a device", lambda path: path.symlink_to("/dev/zero")),
                           ("a link to a FIFO", lambda path: (os.mkfifo(scratch / "fifo"), path.symlink_to(scratch / "fifo")))):
            dcf.unlink()
            make(dcf)
            reply, rows = owner.do(command="project set", node="1", items=["1017=100"])
            require(reply["code"] not in (0, 10) and dcf.name in reply["message"], (name, reply))
            require(owner.do(command="project show")[0]["code"] != 10, name)
            (dcf.rmdir if dcf.is_dir() and not dcf.is_symlink() else dcf.unlink)()
            dcf.write_bytes(content)
            require(not dcf.with_name(dcf.name + ".new").exists(), name)
        # The list itself.
        nodelist = folder / "nodelist.cpj"
        listed = nodelist.read_bytes()
        nodelist.unlink()
        os.mkfifo(nodelist)
        reply, _ = owner.do(command="project show")
        require(reply["code"] == 3 and "nodelist.cpj" in reply["message"], reply)
        nodelist.unlink()
        nodelist.write_bytes(listed)
        require(owner.do(command="project set", node="1", items=["1017=100"])[0]["code"] == 0, "it is a file again")
        content = dcf.read_bytes()
        kept.write_bytes(content)
        dcf.unlink()
        dcf.symlink_to(kept)
        reply, _ = owner.do(command="project set", node="1", items=["1017=200"])
        require(reply["code"] == 5 and f"{dcf.name}: is a symbolic link, which is not followed" in reply["message"], reply)
        require(kept.read_bytes() == content, "a file outside of the project was changed")


@check
def web_a_browser_that_goes_in_the_middle_of_a_command():
    """What it began ends, stands in the audit log, and the next one has his turn."""
    folder, log = new_project("web-gone"), scratch / "web-gone.audit"
    log.unlink(missing_ok=True)
    for name in ("encoder", "drive"):
        command(program, "project", "add", folder, DEVICES / f"{name}.eds", "--bit-rate", "250k")
    with running_page(folder, "--audit", log) as page:
        gone, next_one = PageClient(page), PageClient(page)
        for words in ({"command": "project diff"}, {"command": "project set", "node": "1", "items": ["1017=777"]}, {"command": "scan"}):
            gone.begin(**words)
        require(gone.do(command="hello")[0]["code"] == 0, "it has read what was said before")
        gone.watcher.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))  # a reset, no word
        gone.watcher.file.close()
        gone.watcher.socket.close()
        reply, rows = next_one.do(command="project show")
        require(reply["code"] == 0 and len(rows) == 3, reply)
        done = lambda: [json.loads(line) for line in log.read_text().splitlines()] if log.exists() else []
        until(lambda: sum(any(word in one["do"] for word in ("project diff", "project set", "scan")) for one in done()) == 3, f"the log has {log.read_text()}")
        require("777" in command(program, "project", "show", folder, "1", "--json").stdout, "what had begun was not done")
        require(not list(folder.glob("*.new")), "something is half written")


@check
def web_nobody_without_the_key_locks_its_owner_out():
    """Half requests and watchers give way to who has the key; what they and he send is not kept without a bound."""
    with running(first_plant_file(), operational=[1], words=["--web"]) as plant:
        _, port = page_of(plant)
        half = [socket.create_connection(("127.0.0.1", port), PATIENCE) for _ in range(80)]
        for one in half:
            one.sendall(b"GET / HT")
        upgrade = (f"GET /events HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nOrigin: http://127.0.0.1:{port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                   "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n").encode()
        watchers = [socket.create_connection(("127.0.0.1", port), PATIENCE) for _ in range(64)]
        for one in watchers:
            one.sendall(upgrade)
        owner = PageClient(plant)
        require(owner.do(command="hello")[0]["role"] == "configure", "the owner has no place")
        before = memory_of(plant.process)
        for _ in range(8):
            owner.number += 1
            wish = json.dumps({"do": {"command": "pace", "speed": 1, "filler": "x" * 1_500_000}, "id": owner.number}).encode()
            owner.watcher.socket.sendall(frame(0x81, wish))
            reply, _ = owner.end(owner.number)
            require(reply["code"] == 2 and 'unknown "filler"' in reply["message"], reply)
        grown = memory_of(plant.process) - before
        require(grown < 20, f"{grown:.0f} MB more after 12 MB of commands")
        print(f"    {grown:.1f} MB more after 12 MB of commands")
        for one in half + watchers:
            one.close()
        code, errors = plant.stop()
        require(code == 0, errors)
