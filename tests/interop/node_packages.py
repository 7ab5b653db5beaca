"""The npm packages of all checks: one folder, one lock file, installed once, whichever check of whichever run needs them first."""
import contextlib
import fcntl
import json
import re
import time


@contextlib.contextmanager
def one_at_a_time(folder):
    """Checks run side by side, and so may runs; what they do to the folder's packages in here, they do one after the other."""
    with (folder / "package-lock.json").open() as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield


def is_newer(folder, made, but=("node_modules",)):
    """Whether a file below `folder` was changed after the file `made`. Subfolders of the names `but` do not count."""
    for entry in folder.iterdir():
        if entry.is_dir():
            if entry.name not in but and is_newer(entry, made, but):
                return True
        elif entry.stat().st_mtime_ns > made.stat().st_mtime_ns:
            return True
    return False


class NoRegistry(Exception):
    """The npm registry cannot be reached."""


def install(folder, run_folder, npm, pauses=(10, 40)):
    """Makes `folder`/node_modules what `folder`/package.json says, by `npm(words)`, which raises where that fails: NoRegistry where there is
    no network, after further attempts behind these pauses. Checks of one run, whose folder is `run_folder`, try it once: the others fail
    with the same words."""
    if is_installed(folder):
        return
    failure = run_folder / "npm-failure"
    if not failure.exists():
        said = ""
        for pause in (*pauses, None):
            try:
                # What is optional are serial ports.
                return npm(["ci", "--no-audit", "--no-fund", "--ignore-scripts", "--omit=optional", "--fetch-retries=3"])
            except Exception as error:
                said = str(error)
            if pause is None or not is_of_the_network(said):
                break
            time.sleep(pause)
        failure.write_text(said)
    raise (NoRegistry if is_of_the_network(failure.read_text()) else RuntimeError)(failure.read_text())


def is_of_the_network(failure):
    """Whether npm says that it has not reached its registry."""
    return re.search(r"\b(ENOTFOUND|EAI_AGAIN|ECONNREFUSED|ECONNRESET|ETIMEDOUT|ENETUNREACH|EHOSTUNREACH|ERR_SOCKET_TIMEOUT|E50[0234])\b", failure) is not None


def is_installed(folder):
    wanted = json.loads((folder / "package.json").read_text())["dependencies"]
    return all(version_of(folder / "node_modules" / name) == version for name, version in wanted.items())


def version_of(package):
    try:
        return json.loads((package / "package.json").read_text())["version"]
    except (OSError, ValueError):
        return None
