"""What a notebook shows. The judge of pictures is an XML reader, of tables an HTML reader."""
import base64
import html.parser
import json
import pathlib
import re
import xml.etree.ElementTree

import pytest

pytest.importorskip("canopus._core", reason="the Python module is not built")
import canopus  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]
FIRST = ROOT / "examples/first-plant/plant.toml"
BLOCK = ROOT / "examples/devices/io-block.eds"
EVIL = "<script>alert('\"&')</script>"


class Table(html.parser.HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.tags, self.rows, self.caption = set(), [], ""
        self._inside = ""
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.add(tag)
        self._inside = tag
        if tag == "tr":
            self.rows.append([])
        if tag in ("td", "th"):
            self.rows[-1].append("")

    def handle_endtag(self, tag):
        self._inside = ""

    def handle_data(self, data):
        if self._inside in ("td", "th"):
            self.rows[-1][-1] += data
        if self._inside == "caption":
            self.caption += data


def drawing(picture):
    """The title, texts and curves of an SVG."""
    tree = xml.etree.ElementTree.fromstring(picture.svg)
    assert tree.tag == "{http://www.w3.org/2000/svg}svg"
    assert {each.tag.split("}")[1] for each in tree.iter()} <= {"svg", "title", "style", "rect", "text", "path", "line"}
    texts = ["".join(each.itertext()) for each in tree.iter() if each.tag.endswith("}text")]
    curves = [each.get("d") for each in tree.iter() if each.get("class") == "curve"]
    return texts, curves


def hostile(name):
    return ('[plant]\nname = "x"\n[[bus]]\nname = "a"\nbit_rate = 125_000\n[[device]]\nnode = 2\n'
            f'name = {json.dumps(name)}\neds = {json.dumps(str(BLOCK))}\n')


def test_a_plant_is_a_table_of_its_devices():
    with canopus.Plant(FIRST) as plant:
        before = Table(plant._repr_html_())
        assert before.rows[0] == ["bus", "node", "device", "NMT state"] and before.rows[1] == ["line1", "2", "io-block", "off"]
        plant.run(3)
        after = Table(plant._repr_html_())
        assert after.caption == "3 s" and after.rows[1][3] == "operational" and len(after.rows) == 4
    assert "closed" in Table(plant._repr_html_()).caption


def test_to_look_at_a_plant_changes_nothing():
    with canopus.Plant(FIRST) as plant:
        plant._repr_html_()
        plant.device("io-block")._repr_html_()
        plant.device("io-block").every(1)(print)  # refused once the devices are on


def test_a_device_is_a_table_of_its_process():
    with canopus.Plant(FIRST) as plant:
        device = plant.device("io-block")
        device["6000:01"] = 90
        table = Table(device._repr_html_())
        assert table.caption == "io-block" and ["6000:01", "Digital inputs 1 to 8", "UNSIGNED8", "90"] in table.rows


def test_a_device_file_and_a_master_are_tables():
    assert ["1018:02", "Product code", "UNSIGNED32", "ro", "1025"] in Table(canopus.DeviceFile(BLOCK)._repr_html_()).rows
    with canopus.Plant("x.toml", text=hostile("x")) as plant, canopus.Master(plant, slaves={2: BLOCK}) as master:
        master.boot(timeout=5)
        assert Table(master._repr_html_()).rows[1][:4] == ["2", "", "booted", "operational"]


def test_names_are_text_and_nothing_else():
    text = BLOCK.read_text().replace("ProductName=Canopus I/O block", "ProductName=" + EVIL).replace(
        "ParameterName=Product code", "ParameterName=" + EVIL)
    with canopus.Plant("x.toml", text=hostile(EVIL)) as plant:
        shown = [plant, plant.device(EVIL), canopus.DeviceFile("x.eds", text=text)]
        picture = plant.draw(title=EVIL)
        plant.run(1)
        for each in shown:
            table = Table(each._repr_html_())
            assert table.tags <= {"table", "caption", "tr", "th", "td"}
            assert EVIL in [table.caption.split(",")[0], *(cell for row in table.rows for cell in row)]
        texts, _ = drawing(picture)
        assert EVIL in texts
        assert "<script" not in picture._repr_html_()


def test_a_picture_grows_with_the_plant():
    with canopus.Plant(FIRST) as plant:
        picture = plant.draw(["encoder.6004", "4.606C:00", "io-block.6000:09"])
        assert drawing(picture)[1] == [] and len(picture.missing) == 3
        plant.run(2)
        texts, curves = drawing(picture)
        assert len(curves) == 2 and "node 3 (encoder) 6004:00 Position value" in texts
        assert any("250000 bit/s" in text for text in texts)
        assert picture.missing == ["2.6000:09"]
        plant.run(1)
        longer = drawing(picture)[1]
        assert len(longer[0]) > len(curves[0])
    assert drawing(picture)[1] == longer  # also when the plant has gone


def test_a_notebook_shows_a_picture_as_an_image(tmp_path):
    with canopus.Plant(FIRST) as plant:
        picture = plant.draw(title='a "b"')
        plant.run(2)
        match = re.fullmatch(r'<img alt="a &quot;b&quot;" src="data:image/svg\+xml;base64,([A-Za-z0-9+/=]+)">', picture._repr_html_())
        assert base64.b64decode(match[1]).decode() == picture.svg
        picture.save(tmp_path / "x.svg")
        assert (tmp_path / "x.svg").read_text() == picture.svg
        with pytest.raises(canopus.PlantError, match="cannot write"):
            picture.save(tmp_path / "nowhere/x.svg")


def test_a_trace_is_drawn(tmp_path):
    trace = tmp_path / "candump.log"
    trace.write_text("".join(f"({1 + i / 10:.6f}) can0 183#{i * 100:04X}0000\n" for i in range(10)) + "(2.5) can0 703#05\n")
    picture = canopus.draw(trace, nodes={3: ROOT / "examples/devices/encoder.eds"}, signals=["3.6004:00", "3.6000"], bit_rate=500_000)
    texts, curves = drawing(picture)
    assert picture.title == "candump.log" and len(curves) == 1 and curves[0].count("H") == 11 and picture.missing == ["3.6000:00"]
    for wrong in (lambda: canopus.draw(tmp_path / "absent.log"), lambda: canopus.draw(trace, signals=["nobody.6000"])):
        with pytest.raises(canopus.PlantError):
            wrong()


def test_wrong_signals_and_buses_are_sentences():
    with canopus.Plant(FIRST) as plant:
        for wrong in (lambda: plant.draw(["nobody.6000"]), lambda: plant.draw(["6000"]), lambda: plant.draw(bus="b")):
            with pytest.raises(canopus.PlantError):
                wrong()
