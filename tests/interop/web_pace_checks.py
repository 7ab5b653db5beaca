"""Checks of run, pause, step and speed on the page of a run."""
from kit import check, first_plant_file, require, running, scratch
from web_checks import PageClient, Watcher, page_of


@check
def web_requests_to_modules_wait_while_plant_time_stands_still():
    with running(first_plant_file(), operational=[1, 2, 3], words=["--web"]) as plant:
        page = PageClient(plant)
        require(page.do(command="pace", speed=0)[0]["code"] == 0, "pause")
        page.watcher.say({"do": {"command": "reset module", "number": 0}, "id": 100})
        reply = page.do(command="clear errors", number=0)[0]
        require(reply["code"] == 5 and "not yet over" in reply["message"], reply)
        require(page.do(command="clear errors", number=1)[0]["message"] == "number: expected that of a module of the plant, 0 to 0", "number")
        require(page.do(command="pace", speed=100)[0]["code"] == 0, "faster")
        reply = page.watcher.event(lambda e: e["event"] == "reply" and e["id"] == 100)
        require(reply["code"] == 0 and reply["rows"] == [{"module": "ME3CAN1-Q U0", "said": "restarted in 6.000 s: Y02 ON until X02 is ON", "seconds": 6.0}], reply)
        looker = Watcher(page_of(plant)[1])
        looker.say({"do": {"command": "clear errors", "number": 0}, "id": 1})
        require(looker.event(lambda e: e["event"] == "reply")["code"] == 7, "who only looks")


@check
def web_plant_time_stands_still_steps_and_goes_faster():
    with running(first_plant_file(), operational=[1, 2, 3], words=["--web"]) as plant:
        page = PageClient(plant)
        require("pace" in page.do(command="hello")[0]["offers"], "offers")
        require(page.state()["speed"] == 1, "as the clock")
        require(page.do(command="pace", speed=0)[0]["code"] == 0, "pause")
        first = page.state(lambda e: e["speed"] == 0)
        require(all(page.state()["t"] == first["t"] for _ in range(3)), "it went on")
        # A client within the run waits in plant time; one of another process would be without an answer for 500 ms of the clock.
        rows = page.do(command="sdo read", node="2", object="1000")[1]
        require(rows == [{"node": 2, "object": "1000:00", "reason": "plant time stands still"}], rows)
        # A step is exactly as long as it was said.
        for text, seconds in (("100ms", 0.1), ("1us", 1e-6), ("2s", 2.0)):
            before = page.state()["t"]
            require(page.do(command="pace", run=text)[0]["code"] == 0, text)
            after = page.state(lambda e: e["speed"] == 0 and e["t"] > before)
            require(abs(after["t"] - before - seconds) < 1e-9, (before, after["t"], text))
            require(page.state()["t"] == after["t"], "it goes on after a step")
        require(page.state()["buses"][0]["frames"] > first["buses"][0]["frames"], "no frames in two seconds")
        # Twenty seconds of the plant long before twenty of the clock: the check ends in time, or it does not go faster.
        before = page.state()["t"]
        require(page.do(command="pace", speed=100)[0]["code"] == 0, "faster")
        page.state(lambda e: e["t"] > before + 20)
        require(page.state()["speed"] == 100, "speed")
        require(all(node["in_operation"] for node in page.state()["nodes"]), "somebody did not keep up")
        for words in ({}, {"speed": -1}, {"speed": 101}, {"speed": 0.001}, {"speed": "2"}, {"speed": None}, {"speed": True}, {"run": "soon"}, {"run": "-1s"}):
            reply = page.do(command="pace", **words)[0]
            require(reply["code"] != 0 and "expected" in reply["message"], (words, reply))
        require(page.do(command="pace", speed=1)[0]["code"] == 0 and page.state(lambda e: e["speed"] == 1), "again as the clock")
        looker = Watcher(page_of(plant)[1])
        looker.say({"do": {"command": "pace", "speed": 0}, "id": 1})
        require(looker.event(lambda e: e["event"] == "reply" and e["id"] == 1)["code"] == 7, "who only looks")


@check
def web_plant_time_of_a_bus_outside_goes_with_the_clock():
    with running(first_plant_file(), operational=[1, 2, 3]) as far:
        plant_file = scratch / "web-pace-linked.toml"
        plant_file.write_text(f'[[bus]]\nname = "line1"\nbit_rate = 250_000\nlink = "socketcand:{far.socketcand}/line1"\n')
        with running(plant_file, has_plc=False, words=["--web"], is_served=False) as plant:
            page = PageClient(plant)
            require("pace" not in page.do(command="hello")[0]["offers"], "offers")
            reply = page.do(command="pace", speed=0)[0]
            require(reply["code"] == 2 and "unknown command" in reply["message"], reply)
