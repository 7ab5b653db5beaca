"""Checks of the words that the page has for values of the communication profile: its script alone, run by Node.js, without a browser."""
import json
import shutil

from kit import ROOT, Skip, check, command, require

WORDS = {
    ("1000:00", "0x00020192"): "CiA 402",
    ("1005:00", "0x40000080"): "CAN-ID 080H, produces SYNC",
    ("1006:00", "2500"): "every 2.5 ms",
    ("1014:00", "0x80000084"): "off",
    ("1016:01", "0x000405DC"): "node 4, lost after 1500 ms",
    ("1016:02", "0"): "nobody",
    ("1017:00", "2000"): "every 2 s",
    ("1400:01", "0x20012345"): "CAN-ID 00012345H (29 bits)",
    ("1400:02", "1"): "taken at the next SYNC",
    ("1600:01", "0x62000108"): "6200:01, 8 bits",
    ("1800:01", "0x40000184"): "CAN-ID 184H, no remote request",
    ("1800:01", "0xC0000184"): "off",
    ("1800:02", "5"): "synchronous, every 5 SYNCs",
    ("1800:02", "250"): "reserved",
    ("1800:02", "255"): "event-driven",
    ("1800:03", "15"): "a pause of 1.5 ms at least",
    ("1800:05", "100"): "after 100 ms at the latest",
    ("1F80:00", "0x2D"): "flying NMT master, does not start the slaves, is started by its application",
    ("1F80:00", "0x13"): "NMT master, starts all nodes by one command, resets all nodes when a mandatory slave is lost",
    ("1F80:00", "0"): "not an NMT master",
    ("1F81:04", "0x01F4030D"): "a mandatory slave, is booted, is guarded every 500 ms, lost after 3",
    ("1F81:04", "0x11"): "an optional slave, is not booted, is not reset while it is operational",
    ("1F89:00", "0"): "as long as it takes",
    # A name of CiA 306, no number, the number of entries, an object of the device: no words.
    ("1800:01", "$NODEID+0x180"): "",
    ("1017:00", None): "",
    ("1016:00", "3"): "",
    ("6000:01", "1"): "",
}


@check
def values_of_the_communication_profile_in_words():
    if not shutil.which("node"):
        raise Skip("node is not installed")
    script = (f'import {{ words_of }} from {json.dumps(str(ROOT / "canopus/serve/web/page/value_words.js"))};'
              f"console.log(JSON.stringify({json.dumps([list(key) for key in WORDS])}.map(([object, value]) => words_of(object, value))));")
    said = json.loads(command("node", "--input-type=module", "--eval", script).stdout)
    script = (f'import {{ value_text }} from {json.dumps(str(ROOT / "canopus/serve/web/page/value_words.js"))};'
              'console.log([value_text("1400:01", 0x80000183), value_text("1A00:01", 7), value_text("1A00:00", 2), value_text("1017:00", 500),'
              ' value_text("1018:02", 0x402), value_text("1800:01", "$NODEID+0x180"), value_text("1017:00", null)].join("|"));')
    texts = command("node", "--input-type=module", "--eval", script).stdout.strip()
    require(texts == "0x80000183|0x00000007|2|500|0x00000402|$NODEID+0x180|", texts)
    for (place, words), shown in zip(WORDS.items(), said, strict=True):
        require(shown == words, f"{place}: {shown!r} instead of {words!r}")
