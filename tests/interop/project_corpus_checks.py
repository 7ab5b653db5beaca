"""Device files of other makers as nodes of a project: changed in one value one line differs, taken back they are the same bytes, and a project of
another tool's own DCFs keeps those that nobody changed."""
import concurrent.futures
import json
import re
import shutil
import subprocess

from kit import PATIENCE, ROOT, Skip, check, command, program, require, scratch

FILES = ROOT.parent / "shared/data/eds"


def project(*words, **options):
    return command(program, "project", *words, **options)


def corpus(*kinds):
    if not FILES.exists():
        raise Skip(f"{FILES} is not there")
    return sorted(path for path in FILES.iterdir() if path.suffix.lower() in kinds)


def lines_that_differ(before, after):
    """(gone, new)"""
    gone, new = before.split(b"\n"), after.split(b"\n")
    while gone and new and gone[0] == new[0]:
        gone.pop(0), new.pop(0)
    while gone and new and gone[-1] == new[-1]:
        gone.pop(), new.pop()
    return gone, new


def value_to_set(folder, node):
    """OBJECT=VALUE of the first object that takes one, or None."""
    for line in project("show", folder, node, "--all", "--json").stdout.splitlines():
        row = json.loads(line)
        # 1003H: the reader makes it where a file has none.
        if row.get("type") not in ("UNSIGNED8", "UNSIGNED16", "UNSIGNED32") or row["access"] not in ("rw", "wo", "rww", "rwr") or row["object"].startswith("1003"):
            continue
        value = row["value"] if isinstance(row["value"], int) else 0
        for other in (value + 1, value - 1):
            if row.get("low", 0) <= other <= row.get("high", 255):
                return f"{row['object']}={other}"
    return None


def change_in_one_value(path):
    """As a node of a project of its own. Returns the name of a file that has nothing to be set, or None."""
    folder = scratch / f"corpus-{path.name}"
    shutil.rmtree(folder, ignore_errors=True)
    own = path.read_bytes()
    project("new", folder)
    node = re.search(r"node (\d+)", project("add", folder, path).stdout)[1]
    (file,) = (one for one in folder.iterdir() if one.suffix in (".dcf", ".xdc"))
    before, listed = file.read_bytes(), (folder / "nodelist.cpj").read_bytes()
    item = value_to_set(folder, node)
    if item is None:
        return path.name
    project("set", folder, node, item)
    gone, new = lines_that_differ(before, file.read_bytes())
    require(len(gone) <= 1 and len(new) == 1, f"{path.name}, {item}: {gone} became {new}")
    require((folder / "nodelist.cpj").read_bytes() == listed, f"{path.name}: the list was changed")
    project("undo", folder)
    require(file.read_bytes() == before and path.read_bytes() == own, f"{path.name}: other bytes afterwards")
    return None


@check
def device_files_of_other_makers_change_in_one_line_of_a_project():
    files = corpus(".eds", ".dcf", ".xdd", ".xdc")
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        without = [name for name in pool.map(change_in_one_value, files) if name]
    print(f"    {len(files)} files, of which {len(without)} have nothing that can be set")
    require(len(files) >= 41 and without == ["edsdcfnet_modular-device.dcf"], without)


@check
def dcfs_of_another_tool_are_saved_as_they_were():
    """A project that was made by hand of DCFs as they are: looking changes no byte, and a change changes the file that it is about."""
    folder = scratch / "corpus-foreign"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    listed = ["[Topology]\r\n", "NetName=of another tool\r\n", "; a comment\r\n", "Nodes=0x%02X\r\n"]
    for node, path in enumerate(corpus(".dcf"), 1):
        shutil.copyfile(path, folder / path.name)
        listed += [f"Node{node}Present=0x01\r\n", f"Node{node}Name={path.stem}\r\n", f"Node{node}DCFName={path.name}\r\n"]
    count = len(corpus(".dcf"))
    listed += ["EDSBaseName=.\r\n", "\r\n", "[Of a tool that nobody knows]\r\n", "Key = value ; kept\r\n"]
    (folder / "nodelist.cpj").write_bytes("".join(listed).replace("0x%02X", f"0x{count:02X}").encode())
    before = {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}

    def changed():
        return sorted(path.name for path in folder.iterdir() if path.is_file() and before.get(path.name) != path.read_bytes())
    rows = [json.loads(line) for line in project("show", folder, "--json").stdout.splitlines()]
    require(sum("node" in row for row in rows) == count, rows)
    for words in (("check", folder), ("pdo", "list", folder, "--all"), ("report", folder, scratch / "corpus-foreign.html")):
        # It ends as it likes: foreign files have mistakes.
        subprocess.run([program, "project", *map(str, words)], capture_output=True, timeout=PATIENCE)
    require(changed() == [], f"looking has changed {changed()}")
    for node, path in enumerate(corpus(".dcf"), 1):
        item = value_to_set(folder, node)
        if item is None:
            continue
        project("set", folder, node, item)
        gone, new = lines_that_differ(before[path.name], (folder / path.name).read_bytes())
        require(changed() == [path.name] and len(gone) <= 1 and len(new) == 1, (path.name, item, changed(), gone, new))
        project("undo", folder)
        require(changed() == [], f"{path.name}: other bytes after undo")

