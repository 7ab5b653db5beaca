"""Checks of the page's users: log-ins, sessions, roles, limits and the audit log, by programs we did not write (http.client, crypt of
Debian's libcrypt by Perl, a real Chromium)."""
import base64
import concurrent.futures
import contextlib
import http.client
import http.server
import json
import os
import pathlib
import pty
import re
import shutil
import socket
import stat
import struct
import termios
import threading
import time
import urllib.parse

from kit import HERE, PATIENCE, browser, check, command, first_plant_file, page_files, program, require, running, scratch, tier, until

PASSWORD = "correct horse ä&=+%"


def users_file(name, **roles):
    """Users with this password, by their roles."""
    path = scratch / name
    path.unlink(missing_ok=True)
    for user, role in roles.items():
        command(program, "web-users", "add", path, user, "--role", role, input=PASSWORD + "\n")
    return path


@contextlib.contextmanager
def page_with(users, *words):
    page_files()
    with running(first_plant_file(), operational=[1], words=["--web", "--web-users", users, *words]) as plant:
        address = plant.wait(lambda e: e["event"] == "listen" and e["protocol"] == "web")["address"]
        require(re.fullmatch(r"http://[0-9.]+:\d+/", address), address)
        yield plant, int(address.split(":")[2].rstrip("/"))


class Browser:
    """Keeps a cookie and says Origin as a browser does."""

    def __init__(self, port, origin=None):
        self.port, self.cookie = port, None
        self.origin = origin or f"http://127.0.0.1:{port}"

    def ask(self, method, path, form=None, **fields):
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=PATIENCE)
        if self.cookie:
            fields["Cookie"] = self.cookie
        if form is not None:
            fields = {"Origin": self.origin, "Content-Type": "application/x-www-form-urlencoded", **fields}
            form = urllib.parse.urlencode(form)
        connection.request(method, path, form, fields)
        answer = connection.getresponse()
        answer.text = answer.read().decode()
        connection.close()
        if cookie := answer.getheader("Set-Cookie"):
            self.cookie = cookie.split(";")[0]
        return answer

    def log_in(self, name, password=PASSWORD):
        return self.ask("POST", "/login", {"name": name, "password": password})

    def session(self):
        return json.loads(self.ask("GET", "/session").text)

    def web_socket(self, query="", origin=None):
        """Status, and the connection."""
        client = socket.create_connection(("127.0.0.1", self.port), PATIENCE)
        key = base64.b64encode(os.urandom(16)).decode()
        client.sendall((f"GET /events{query} HTTP/1.1\r\nHost: 127.0.0.1:{self.port}\r\nOrigin: {origin or self.origin}\r\n"
                        + (f"Cookie: {self.cookie}\r\n" if self.cookie else "") +
                        "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
                        f"Sec-WebSocket-Key: {key}\r\n\r\n").encode())
        stream = client.makefile("rb")
        status = int(stream.readline().split()[1])
        while stream.readline().strip():
            pass
        return status, client, stream


def reply_to(client, stream, wish, number=1):
    """What becomes of a command."""
    data = json.dumps({"do": wish, "id": number}).encode()
    client.sendall(bytes([0x81, 0x80 | len(data), 0, 0, 0, 0]) + data)
    while True:
        first, size = stream.read(2)
        if size >= 126:
            size, = struct.unpack("!H", stream.read(2)) if size == 126 else struct.unpack("!Q", stream.read(8))
        message = stream.read(size)
        for event in json.loads(message) if first == 0x81 else []:
            if event["event"] == "reply" and event["id"] == number and "code" in event:
                return event


@check
def web_users_file():
    """canopus web-users: hashes that crypt() of another program takes, a file for its owner alone, comments that stay, a terminal that
    does not show what is typed."""
    path = users_file("users-1", anna="operate", bob="look")
    require(stat.S_IMODE(path.stat().st_mode) == 0o600, oct(path.stat().st_mode))
    for line in path.read_text().splitlines():
        name, role, hash_text = line.split()
        if shutil.which("perl"):
            made = command("perl", "-e", "print crypt($ARGV[0], $ARGV[1])", PASSWORD, hash_text).stdout
            require(made == hash_text and made.startswith("$y$j9T$"), f"{name} {role}: perl's crypt says {made}")
    text = "# first\n\n" + path.read_text().replace("bob", "  bob") + "# last"
    path.write_text(text)
    command(program, "web-users", "add", path, "carl", "--role", "configure", input=PASSWORD + "\n")
    require(path.read_text().startswith(text + "\ncarl configure $y$"), path.read_text())
    command(program, "web-users", "add", path, "anna", "--role", "look", "--replace", input=PASSWORD + "\n")
    command(program, "web-users", "remove", path, "bob")
    listed = command(program, "web-users", "list", path, "--json").stdout.splitlines()
    require([(u["name"], u["role"], u["line"]) for u in map(json.loads, listed)] == [("anna", "look", 3), ("carl", "configure", 5)], listed)
    require(path.read_text().startswith("# first\n\nanna look ") and "\n# last\n" in path.read_text(), path.read_text())
    before = path.read_text()
    for words, code, said in ((["add", path, "anna"], 1, "anna is a user already"), (["remove", path, "bob"], 1, "bob is no user"),
                              (["add", path, "a b"], 2, "expected 1 to 32"), (["add", path, "x", "--role", "root"], 2, "root"),
                              (["add", path, "dora"], 1, "8 to 256 bytes"), (["list", scratch / "none"], 1, "No such file")):
        done = command(program, "web-users", *words, input="short\n", expect=code)
        require(said in done.stderr, done.stderr)
    require(path.read_text() == before, "a refused change has changed the file")
    # On a terminal: asked for twice, and nothing of it shown.
    pid, terminal = pty.fork()
    if pid == 0:
        os.execv(program, [program, "web-users", "add", str(path), "dora"])
    shown = b""
    for wanted in (b"not shown", b"again"):
        while wanted not in shown:
            shown += os.read(terminal, 1000)
        until(lambda: not termios.tcgetattr(terminal)[3] & termios.ECHO, "the terminal shows what is typed")
        os.write(terminal, PASSWORD.encode() + b"\n")
    with contextlib.suppress(OSError):
        while more := os.read(terminal, 1000):
            shown += more
    require(os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]) == 0 and b"horse" not in shown, shown)
    require("\ndora look $y$" in path.read_text(), path.read_text())


@check
def web_users_refused():
    """A file of users that is wrong, or open to others, and an address without users, end the run before it begins."""
    plant = first_plant_file()
    path = users_file("users-2", anna="operate")
    good = path.read_text()

    def refused(said, *words):
        done = command(program, "run", plant, "--web", *words, "--free-ports", "--for", "1s", expect=1)
        require(said in done.stderr, done.stderr)

    refused("unless it has users", "0.0.0.0:0")
    for text, said in (("anna operate\n", f"{path}:1: expected NAME ROLE HASH, found 2 words"), ("# nobody\n", "expected a user"),
                       (good + "bob admin " + good.split()[2], f"{path}:2: \"admin\" is no role"),
                       ("anna look hunter2-hunter2\n", f"{path}:1: expected a yescrypt or scrypt hash"),
                       (good + good, f"{path}:2: anna is in line 1 already"), ("\0\x1b[2J\n" * 50, f"{path}:1: expected NAME ROLE HASH")):
        path.write_text(text)
        refused(said, "0.0.0.0:0", "--web-users", path)
        refused(said, "--web-users", path)
    path.write_text(good)
    path.chmod(0o644)
    refused("its mode is 0644: others can read it", "--web-users", path)
    refused("No such file", "--web-users", scratch / "none")
    path.chmod(0o600)
    refused("expected a file", "--web-users", path, "--web-audit", "/dev/null")
    command(program, "run", plant, "--web-users", path, expect=2)
    command(program, "run", plant, "--web", "--web-origin", "plant.example", expect=2)


@check
def web_log_in():
    """Without a session nobody sees the plant; roles, the key of the session, log-out, and each of it in the audit log."""
    path = users_file("users-3", anna="operate", bob="look", carl="configure")
    with page_with(path) as (plant, port):
        nobody = Browser(port)
        require(nobody.ask("GET", "/").getheader("Location") == "/login", "the page without a session")
        require(nobody.ask("GET", "/session").status == 401 and nobody.web_socket()[0] == 401, "a session of nobody")
        require("<form" in nobody.ask("GET", "/login").text, "no form")
        wrong, unknown = nobody.log_in("anna", "wrong"), nobody.log_in("hunter2")
        require(wrong.status == unknown.status == 401 and wrong.text == unknown.text, "the answer tells who is a user")
        for origin in ("http://evil.example", "null", f"http://localhost:{port}"):
            require(Browser(port, origin).log_in("anna").status == 403, origin)
        for name, role, code in (("anna", "operate", 0), ("bob", "look", 7), ("carl", "configure", 0)):
            user = Browser(port)
            answer = user.log_in(name)
            require(answer.status == 303 and answer.getheader("Location") == "/", answer.text)
            fields = answer.getheader("Set-Cookie").split("; ")
            require(fields[0].startswith(f"canopus_{port}=") and set(fields[1:]) == {"Path=/", "HttpOnly", "SameSite=Strict"}, fields)
            require(user.ask("GET", "/").status == 200, "the page")
            session = user.session()
            require(session["user"] == name and session["role"] == role, session)
            status, client, stream = user.web_socket(f"?key={session['key']}")
            require(status == 101, status)
            hello = reply_to(client, stream, {"command": "hello"})
            require(hello["user"] == name and hello["role"] == role, hello)
            require(reply_to(client, stream, {"command": "arm", "on": True}, 2)["code"] == code, name)
            _, other, other_stream = user.web_socket()
            require(reply_to(other, other_stream, {"command": "hello"})["role"] == "look", "without the key of the session")
            require(user.web_socket(f"?key={session['key']}", "http://evil.example")[0] == 403, "a page of another site")
            require(user.ask("POST", "/logout", {"key": "0" * 32}).status == 403, "a log-out without the key")
            require(user.ask("POST", "/logout", {"key": session["key"]}).status == 303, "log-out")
            with contextlib.suppress(ConnectionError):
                while stream.read(10000):
                    pass  # its pages end with the session
            require(user.ask("GET", "/session").status == 401, "after the log-out")
        event = plant.stop()[0]
        require(event == 0, event)
    lines = [json.loads(line) for line in pathlib.Path(f"{path}.audit").read_text().splitlines()]
    seen = [(e["user"], e["role"], e["do"], e["code"]) for e in lines]
    require(seen[:2] == [("anna", "look", "log in", 1), ("?", "look", "log in", 1)] and "hunter2" not in str(lines), seen)
    require(seen[2:5] == [("anna", "operate", "log in", 0), ("anna", "operate", "arm", 0), ("anna", "operate", "log out", 0)], seen)
    require(("bob", "look", "arm", 7) in seen and len(seen) == 11, seen)
    require([e.get("message") for e in lines if e["do"] == "arm"] == [None, "arm: the role operate is needed, yours is look", None], lines)
    require(all(re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{3}Z", e["at"]) and e["address"].startswith("127.0.0.1:") for e in lines), lines)
    require(stat.S_IMODE(pathlib.Path(f"{path}.audit").stat().st_mode) == 0o600, "the audit log is open to others")


@check
def web_removed_user():
    """Who is taken out of the file is out without a restart; a file that has become wrong changes nothing."""
    path = users_file("users-4", anna="operate", bob="look")
    with page_with(path) as (plant, port):
        anna, bob = Browser(port), Browser(port)
        anna.log_in("anna")
        bob.log_in("bob")
        _, client, stream = anna.web_socket()
        _, staying, _ = bob.web_socket()
        good = path.read_text()
        path.write_text(good + "nonsense\n")
        plant.wait(lambda e: e["event"] == "error" and f"{path}:3: expected NAME ROLE HASH" in e["message"])
        require(anna.ask("GET", "/session").status == 200, "a wrong file has ended a session")
        path.write_text(good)
        command(program, "web-users", "remove", path, "anna")
        until(lambda: anna.ask("GET", "/session").status == 401 or time.sleep(0.5), "a removed user is still there")
        with contextlib.suppress(ConnectionError):
            while stream.read(10000):
                pass
        require(bob.ask("GET", "/session").status == 200 and anna.log_in("anna").status == 401, "the others")


@check
def web_log_in_floods():
    """Guessing waits longer and longer, 40 log-ins at once are answered, and hashes do not stop the plant."""
    path = users_file("users-5", anna="operate")
    # A hash of 64 MiB: what takes long enough to be noticed.
    if shutil.which("perl"):
        made = command("perl", "-e", 'print crypt($ARGV[0], "\\$y\\$jBT\\$abcdefghijklmnop")', PASSWORD).stdout
        path.write_text(f"anna operate {made}\n")
    with page_with(path) as (plant, port):
        statuses = []
        while 429 not in statuses and len(statuses) < 20:  # each wait is twice the last one: sooner or later it is longer than a log-in takes
            answer = Browser(port).log_in("anna", "wrong")
            statuses.append(answer.status)
        require(statuses[:5] == [401] * 5 and statuses[-1] == 429 and int(answer.getheader("Retry-After")) >= 1, statuses)
        require("Too many attempts. Wait" in answer.text, answer.text)
        with concurrent.futures.ThreadPoolExecutor(40) as pool:
            many = list(pool.map(lambda _: Browser(port).log_in("anna", "wrong").status, range(40)))
        require(set(many) <= {401, 429, 503} and 429 in many, many)
        def second_chance():
            answer = Browser(port).log_in("anna")
            if answer.status == 429:
                time.sleep(min(int(answer.getheader("Retry-After")), 5))
            return answer.status == 303
        until(second_chance, "the right password after the wait")
        # Half a log-in holds nobody up.
        with socket.create_connection(("127.0.0.1", port), PATIENCE) as half:
            half.sendall(f"POST /login HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nContent-Length: 100000\r\n\r\n".encode())
            require(Browser(port).ask("GET", "/login").status == 200, "others wait for a half log-in")
        flood = []  # 600 at once and 60 a second are answered
        until(lambda: flood.append(Browser(port).ask("GET", "/login").status) or len(flood) >= 900 and 429 in flood, "none of a flood is refused",
              pause=0)
        require(flood[0] == 200, f"{flood.count(429)} of {len(flood)} refused")
        code, errors = plant.stop()
        require(code == 0, errors)
        lag = plant.wait(lambda e: e["event"] == "summary")["lag"]
        print(f"    the plant was at most {1000 * lag:.1f} ms late; {flood.count(429)} of {len(flood)} requests refused")


class OtherSite(http.server.BaseHTTPRequestHandler):
    """A page of another server, of this host or of another site (localhost is another one than 127.0.0.1)."""
    heard = []

    def do_GET(self):
        OtherSite.heard.append(dict(self.headers))
        self.send_response(200)
        self.send_header("Content-Type", "text/html")
        self.end_headers()
        self.wfile.write(b"<!doctype html><title>other</title><body>other")

    def log_message(self, *_):
        pass


@check
@tier("browser")
def web_log_in_in_chromium():
    """Users in a real browser: wrong password, the page with name and role, a cookie that no script reads and no other site gets, log-out;
    pages of other servers cannot log in, read the session, open the WebSocket or frame the page."""
    chromium = browser()
    path = users_file("users-6", anna="operate")
    other = http.server.ThreadingHTTPServer(("127.0.0.1", 0), OtherSite)
    threading.Thread(target=other.serve_forever, daemon=True).start()
    try:
        with page_with(path) as (plant, port):
            folder = pathlib.Path(os.environ.get("CANOPUS_PICTURES", scratch)) / "log-in"
            folder.mkdir(parents=True, exist_ok=True)
            done = command("node", HERE / "web_users.mjs", chromium, f"http://127.0.0.1:{port}/", f"localhost:{other.server_port}",
                           f"127.0.0.1:{other.server_port}", folder, PASSWORD)
            seen = json.loads(done.stdout)
            require(seen["first"].endswith("/login") and seen["said"] == "The name or the password is wrong.", seen)
            require(seen["role"] == "anna, operate" and seen["log_out"] and seen["plant"], seen)
            require(seen["problems"] == [], seen["problems"])
            cookie, = seen["cookies"]
            require(cookie["name"] == f"canopus_{port}" and cookie["httpOnly"] and cookie["sameSite"] == "Strict", cookie)
            require(seen["document_cookie"] == "", seen["document_cookie"])
            for site in ("other_site", "other_port"):
                require(seen[site] == {"form": 403, "fetch": "refused", "socket": "refused", "frame": "refused"}, f"{site}: {seen[site]}")
            require(seen["from_other_site"].endswith("/login"), "a link of another site brings the session along")
            require(seen["after_log_out"].endswith("/login") and seen["cookies_after"] == [], seen)
            require(seen["axe"] == [], seen["axe"])
            require(plant.stop()[0] == 0, "exit code")
        from_other_site = [h.get("Cookie", "") for h in OtherSite.heard if h["Host"].startswith("localhost")]
        require(from_other_site and not any("canopus" in c for c in from_other_site), from_other_site)
    finally:
        other.shutdown()
        other.server_close()
