"""Checks of the page's users: `canopus web-users`, log-in, sessions, roles and the audit log, by Python's HTTP client."""
import http.client
import json
import os
import re
import socket
import subprocess
import urllib.parse

from kit import PATIENCE, check, command, first_plant_file, program, require, running, scratch

PASSWORD = "correct horse battery"


def add_user(file, name, role):
    done = subprocess.run([program, "web-users", "add", file, name, "--role", role], input=PASSWORD + "\n", text=True,
                          capture_output=True, timeout=PATIENCE)
    require(done.returncode == 0, done.stderr)


def ask(port, method, path, form=None, origin=None, cookie=None):
    """Status, headers and text of an answer."""
    client = http.client.HTTPConnection("127.0.0.1", port, timeout=PATIENCE)
    headers = {"Origin": origin or f"http://127.0.0.1:{port}"}
    if cookie:
        headers["Cookie"] = cookie
    body = None
    if form is not None:
        headers["Content-Type"] = "application/x-www-form-urlencoded"
        body = urllib.parse.urlencode(form)
    client.request(method, path, body, headers)
    answer = client.getresponse()
    text = answer.read().decode()
    client.close()
    return answer.status, answer.headers, text


def log_in(port, name, password=PASSWORD, **more):
    status, headers, _ = ask(port, "POST", "/login", {"name": name, "password": password}, **more)
    return status, headers.get("Set-Cookie", "")


@check
def web_users_log_in():
    """Nothing is shown without a log-in; wrong names and passwords get one answer; the cookie is no other site's and no script's; a
    session has its user's role; after the log-out it is none; the audit log has it all, and no password."""
    users = scratch / "users.txt"
    users.unlink(missing_ok=True)
    add_user(users, "anna", "configure")
    add_user(users, "shift", "look")
    require(os.stat(users).st_mode & 0o077 == 0, "others can read the users")
    require(re.search(r"^anna\s+configure\s+\$(y|7)\$", users.read_text(), re.M), users.read_text())
    listed = [json.loads(line) for line in command(program, "web-users", "list", users, "--json").stdout.splitlines()]
    require([(row["name"], row["role"]) for row in listed] == [("anna", "configure"), ("shift", "look")], listed)
    words = ["--web", "0.0.0.0:0", "--web-users", users]
    with running(first_plant_file(), operational=[1], words=words) as plant:
        address = plant.wait(lambda e: e["event"] == "listen" and e["protocol"] == "web")["address"]
        require("key=" not in address, "users need no key")
        port = int(re.search(r":(\d+)/", address)[1])
        status, headers, _ = ask(port, "GET", "/")
        require(status == 303 and headers["Location"].endswith("/login"), (status, headers["Location"]))
        require(ask(port, "GET", "/session")[0] == 401, "a session without a log-in")
        for name, password in (("anna", "wrong horse"), ("nobody", PASSWORD)):
            require(log_in(port, name, password) == (401, ""), (name, "got in"))
        require(log_in(port, "anna", origin="http://evil.example")[0] == 403, "a form of another site")
        status, cookie = log_in(port, "anna")
        require(status == 303, status)
        for attribute in ("HttpOnly", "SameSite=Strict", "Path=/"):
            require(attribute in cookie, cookie)
        anna = cookie.split(";")[0]
        session = json.loads(ask(port, "GET", "/session", cookie=anna)[2])
        require(session["user"] == "anna" and session["role"] == "configure" and len(session["key"]) >= 32, session)
        require("<title>" in ask(port, "GET", "/", cookie=anna)[2], "the page")
        shift = log_in(port, "shift")[1].split(";")[0]
        require(json.loads(ask(port, "GET", "/session", cookie=shift)[2])["role"] == "look", "the role of another user")
        # A guessed cookie, a cookie without its end, another one's name.
        for wrong in (anna[:-1], anna + "0", anna.split("=")[0] + "=" + "0" * 32, "session=1"):
            require(ask(port, "GET", "/session", cookie=wrong)[0] == 401, wrong)
        status, _, _ = ask(port, "POST", "/logout", {"key": "wrong"}, cookie=anna)
        require(status == 403, "a log-out that another site asked for")
        status, _, _ = ask(port, "POST", "/logout", {"key": session["key"]}, cookie=anna)
        require(status == 303 and ask(port, "GET", "/session", cookie=anna)[0] == 401, "the session goes on after the log-out")
        # Half a log-in, and one that is too long, hold nobody up.
        with socket.create_connection(("127.0.0.1", port), PATIENCE) as half:
            half.sendall(b"POST /login HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 100000\r\n\r\n")
            require(ask(port, "GET", "/session", cookie=shift)[0] == 200, "others wait for a half log-in")
    audit = (scratch / "users.txt.audit").read_text()
    require(PASSWORD not in audit and "wrong horse" not in audit, audit)
    lines = [json.loads(line) for line in audit.splitlines()]
    done = [(line["user"], line["do"], line["code"]) for line in lines]
    require(("anna", "log in", 0) in done and ("shift", "log in", 0) in done and ("anna", "log out", 0) in done, done)
    require(("anna", "log in", 1) in done and ("?", "log in", 1) in done, done)
    require(all(line["address"].startswith("127.0.0.1") for line in lines), lines)


@check
def web_users_refused_files():
    """A file that others can read, a wrong line, and a user twice are refused with file and line; other addresses need users."""
    users = scratch / "bad-users.txt"
    for text, mode, said in (("anna configure\n", 0o600, "bad-users.txt:1"), ("# x\nanna boss $y$j9T$abc$def\n", 0o600, "bad-users.txt:2"),
                             ("", 0o644, "bad-users.txt")):
        users.write_text(text)
        os.chmod(users, mode)
        done = command(program, "run", first_plant_file(), "--web", "--web-users", users, "--for", "10ms", "--free-ports", expect=1)
        require(said in done.stderr, done.stderr)
    done = command(program, "run", first_plant_file(), "--web", "0.0.0.0:0", "--for", "10ms", expect=1)
    require("--web-users" in done.stderr or "users" in done.stderr, done.stderr)
