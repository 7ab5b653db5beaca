"""What packages need of the program, judged by shells, by mandoc, and by a service manager made here."""
import json
import os
import pathlib
import re
import shutil
import signal
import socket
import subprocess

from kit import PATIENCE, ROOT, Skip, check, command, program, require, scratch

COMPLETED = {  # words typed: a completion that has to be there
    ("canopus", "tra"): "trace",
    ("canopus", "trace", "conv"): "convert",
    ("canopus", "run", "--vir"): "--virtual",
    ("canopus", "plc", "read", "--for"): "--format",
    ("canopus", "plc", "read", "--format", "h"): "hex",
    ("canopus", "completion", "z"): "zsh",
}


def needed(name):
    if not shutil.which(name):
        raise Skip(f"no {name}")
    return name


def script_of(shell):
    path = scratch / f"completion.{shell}"
    path.write_text(command(program, "completion", shell).stdout)
    return path


@check
def bash_completes_commands_options_and_words():
    script = script_of("bash")
    for words, wanted in COMPLETED.items():
        said = command(needed("bash"), "-euc", f'source {script}; COMP_WORDS=({" ".join(words)}); COMP_CWORD={len(words) - 1}; '
                       '_canopus; printf "%s\\n" "${COMPREPLY[@]}"').stdout.split()
        require(wanted in said, f"{words}: {wanted} is not among {said}")
    # Where a file is wanted bash completes file names by itself.
    said = command("bash", "-uc", f'source {script}; COMP_WORDS=(canopus run pl); COMP_CWORD=2; _canopus; '
                   'printf "%s\\n" "${COMPREPLY[@]}"').stdout.split()
    require(said == [], f"words instead of file names: {said}")


@check
def fish_completes_commands_options_and_words():
    script = script_of("fish")
    home = scratch / "fish-home"
    home.mkdir(exist_ok=True)
    for words, wanted in COMPLETED.items():
        said = command(needed("fish"), "--no-config", "-c", f'source {script}; complete -C "{" ".join(words)}"',
                       env={**os.environ, "HOME": str(home)}).stdout.splitlines()
        require(any(line.split("\t")[0] == wanted for line in said), f"{words}: {wanted} is not among {said}")


@check
def zsh_takes_the_completion():
    script = script_of("zsh")
    folder = scratch / "zsh-functions"
    folder.mkdir(exist_ok=True)
    shutil.copy(script, folder / "_canopus")
    said = command(needed("zsh"), "-f", "-c", f"fpath=({folder} $fpath); autoload -U compinit; compinit -D -u; print $_comps[canopus]; "
                   "autoload +X -U _canopus; print loaded").stdout.split()
    require(said == ["_canopus", "loaded"], said)
    command("zsh", "-n", script)


@check
def every_command_has_a_manual_page_that_mandoc_takes():
    pages = command(program, "reference", "man", "--list").stdout.split("\n")[:-1]
    require(pages[0] == "" and {"run", "trace", "plc", "reference"} <= set(pages), pages)
    for page in pages:
        path = scratch / "page.1"
        path.write_text(command(program, "reference", "man", *([page] if page else [])).stdout)
        said = subprocess.run([needed("mandoc"), "-Tlint", "-Wwarning", path], capture_output=True, text=True).stdout
        said = [line for line in said.splitlines() if "missing date" not in line]
        require(not said, f"{page}: {said}")
    read = subprocess.run(["mandoc", "-Tascii"], input=command(program, "reference", "man", "run").stdout, capture_output=True, text=True)
    plain = re.sub(".\x08", "", read.stdout)                                # bold is a letter twice in one place
    help_text = command(program, "run", "--help").stdout
    for word in ("--expect-operational", "PLANT", "--vcd FILE"):
        require(word in help_text and word in plain, f"{word} is missing")
    require(command(program, "reference", "man", "rnu", expect=2).stderr.startswith('canopus reference man: unknown command "rnu"'), "")


@check
def the_markdown_page_names_every_command_and_option():
    page = command(program, "reference", "markdown").stdout
    for words in (["run"], ["trace", "convert"], ["plc", "watch"], ["lss", "scan"]):
        require(f"# canopus {' '.join(words)}\n" in page, words)
        help_text = command(program, *words, "--help").stdout
        for line in help_text.splitlines():
            if line.startswith("  --"):
                require(f"`{line.split()[0].split(',')[0]}" in page, line)


@check
def a_service_manager_hears_of_the_run():
    path = scratch / "notify.socket"
    path.unlink(missing_ok=True)
    heard = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    heard.bind(str(path))
    heard.settimeout(PATIENCE)
    with heard:
        run = subprocess.Popen([program, "run", ROOT / "examples/network-without-plc/devices.toml", "--free-ports", "--quiet"],
                               env={**os.environ, "NOTIFY_SOCKET": str(path), "WATCHDOG_USEC": "200000"})
        try:
            first = heard.recv(4096).decode()
            require(first.startswith("READY=1\nSTATUS=") and first.endswith(": 3 nodes"), first)
            for _ in range(3):
                require(heard.recv(4096) == b"WATCHDOG=1", "no sign of life")
            run.send_signal(signal.SIGTERM)
            while (last := heard.recv(4096)) == b"WATCHDOG=1":
                pass
            require(last == b"STOPPING=1", last)
            require(run.wait(PATIENCE) == 0, "the exit code of SIGTERM")
        finally:
            run.kill()
            run.wait()
    # A name that is not there, or a plant that does not start, is nobody's READY.
    missing = subprocess.run([program, "run", scratch / "nothing.toml"], capture_output=True,
                             env={**os.environ, "NOTIFY_SOCKET": str(scratch / "gone.socket")})
    require(missing.returncode == 2, missing.returncode)


@check
def the_list_of_parts_names_every_library():
    if not shutil.which("dpkg-query") or not shutil.which("ldd"):
        raise Skip("no Debian")
    listed = json.loads(command(ROOT / "tools/parts-list", program).stdout)
    require(listed["bomFormat"] == "CycloneDX" and listed["specVersion"] == "1.5", listed["bomFormat"])
    names = {part["name"] for part in listed["components"]}
    for library in re.findall(r"=> (/\S+)", command("ldd", program).stdout):
        file = str(pathlib.Path(library).resolve())
        owner = subprocess.run(["dpkg-query", "--search", file, file.removeprefix("/usr")], capture_output=True, text=True).stdout
        require(owner.split(":")[0] in names, f"{library} of {owner} is not listed")
    require(all(part["licenses"][0]["expression"] and part["version"] for part in listed["components"]), "a licence or version lacks")
    table = command(ROOT / "tools/parts-list", program, "--markdown").stdout
    # Of a package without a page of its own the name is no link.
    require(all(re.search(rf"^\| \[?{re.escape(name)}\b", table, re.M) for name in names), table)


@check
def a_project_of_its_own_finds_the_installed_library():
    build = pathlib.Path(program).parent
    if not shutil.which("cmake") or not (build / "cmake_install.cmake").is_file():
        raise Skip("no cmake, or the program lies in no build folder")
    there = scratch / "prefix with a space"
    command("cmake", "--install", build, "--prefix", there)
    for file in ("share/man/man1/canopus-run.1", "share/bash-completion/completions/canopus", "share/canopus/eds/fx3u-can.eds",
                 "lib/systemd/system/canopus@.service", "share/doc/canopus/examples/first-plant/plant.toml"):
        require((there / file).is_file(), f"{file} is not installed")
    project = scratch / "own-project"
    command("cmake", "-S", ROOT / "examples/cpp-device", "-B", project, f"-DCMAKE_PREFIX_PATH={there}", "-DCMAKE_BUILD_TYPE=Debug")
    require(str(there) in (project / "CMakeCache.txt").read_text(), "the sources were taken instead")
    command("cmake", "--build", project)
    said = command(project / "cpp_device", there / "share/doc/canopus/examples/devices/io-block.eds").stdout
    require(said.splitlines()[-2:] == [" 8.018928  pump off", " 8.110000  16 frames on the bus"], said)
    # The other examples, as they were built beside the program: a module of one's own in a rack.
    said = command(build / "examples/example_cpp_module", ROOT / "examples/devices/io-block.eds").stdout
    require("after a second: 11 frames" in said, said)
